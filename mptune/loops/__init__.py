"""The linear loops: Eq. 11 to Eq. 22, their stability, and the sampled loop."""
