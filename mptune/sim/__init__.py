"""The time domain: step responses and moves of the closed loop, and their indices."""
