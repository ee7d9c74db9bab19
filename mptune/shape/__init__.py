"""Loop shaping: the convex core for any loop and any controller linear in its parameters."""
