"""Gains turned by hand in a browser: a page on the loopback interface, everything moving."""
