"""The controller's files: what a target, a simulator or a PLC takes over."""
