"""Gains proven on the nonlinear machine."""
