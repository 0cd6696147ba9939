"""Joins macOS libraries, one a processor, into one file: the universal binary of Apple's `lipo`.

    python3 scripts/universal.py OUTPUT LIBRARY...
"""

import struct
import sys
from pathlib import Path

MAGIC, MAGIC_64 = 0xCAFEBABE, 0xFEEDFACF
# The page of ARM, 16 kB; that of Intel divides it.
ALIGNMENT = 14


def join(libraries):
    """The bytes of the file: a table of processor, place and size in big endian, then the libraries, each from a new page on."""
    table, body = struct.pack(">2I", MAGIC, len(libraries)), b""
    start = 8 + 20 * len(libraries)
    for library in libraries:
        magic, processor, variant = struct.unpack_from("<3I", library)
        if magic != MAGIC_64:
            sys.exit("not a 64-bit library of macOS for one processor")
        body += bytes(-(start + len(body)) % (1 << ALIGNMENT))
        table += struct.pack(">5I", processor, variant, start + len(body), len(library), ALIGNMENT)
        body += library
    return table + body


if __name__ == "__main__":
    output, *paths = map(Path, sys.argv[1:])
    output.write_bytes(join([path.read_bytes() for path in paths]))
    output.chmod(0o755)
