"""Presses two cartilage layers together with FMPy (`pip install fmpy`) and prints load, friction and film.

Run it after `cargo run --release`, which writes the FMU.
"""

from start import FMU, needs, options

needs("numpy", "fmpy")

import numpy as np
from fmpy import simulate_fmu



def main(fmu=FMU, parameters=None):
    """Depths, loads, friction coefficients and least film thicknesses, all in SI units."""
    # FMPy holds an input during a step: the step from 20 s on is that with the last depth.
    press = np.array([(0, -10e-6), (20, 10e-6)], dtype=[("time", float), ("penetration_depth", float)])
    outputs = ["penetration_depth", "load", "friction_coefficient", "minimum_film_thickness"]
    result = simulate_fmu(
        fmu, stop_time=22, output_interval=2, start_values=parameters or {}, input=press, output=outputs
    )
    for _, depth, load, friction, film in result:
        print(f"{1e6 * depth:6.1f} um {load:8.3f} N/m {friction:8.5f} {1e6 * film:7.3f} um")
    return result


if __name__ == "__main__":
    main(**options(__doc__))
