"""Gains that perform best within the margins asked for."""
