"""Many verifications: drawn, run on this machine or a cluster, stored, and what they say."""
