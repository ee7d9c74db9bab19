"""Signals between the machine and its controller: §5.2, Eq. 23, Tustin, references."""
