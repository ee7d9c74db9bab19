"""Guaranteed worst cases over a continuous box of plants, with exact dead time."""
