"""mptune: robust-control design and tuning for multi-pressure hydraulic cylinders."""
