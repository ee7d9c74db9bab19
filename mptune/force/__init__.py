"""The model-based force controller: Eq. 5 to Eq. 10."""
