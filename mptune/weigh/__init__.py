"""The weights of the force controller's cost, Eq. 7: §5.4's order, and a search beyond it."""
