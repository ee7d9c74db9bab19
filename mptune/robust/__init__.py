"""The frequency domain: Eq. 17 and Eq. 21 over a family, margins, verdicts."""
