"""The force loop identified: simulated as in §2.4, or measured on the rig."""
