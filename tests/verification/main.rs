//! Answers that are known, one file a benchmark: each states formula, source, what is varied and its tolerance.
//!
//! Support: a layer with boundary conditions of one's choice ([`strip`]), a film on a line ([`line`]), and the discrete system of
//! two bodies with its fields in reach ([`pair`]); all are made of the crate's own elements, Newton's method and elimination.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod layered_tissue;
mod line;
mod pair;
mod strip;

mod cavitation;
mod consolidation;
mod derivatives;
mod dry_contact;
mod fibre_tissue;
mod film_alone;
mod geometry;
mod harmonic_pressure;
mod identities;
mod joint;
mod joint_ways;
mod mandel;
mod pairing;
mod paper_case;
mod path_independence;
mod porous_film;
mod random_cases;
mod reach;
mod rubbing;
mod soft_film;
mod solid_alone;
mod squeeze;
mod thinning_film;
