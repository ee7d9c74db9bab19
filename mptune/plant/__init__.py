"""The cylinder as physics has it: Eq. 1 to Eq. 4."""
