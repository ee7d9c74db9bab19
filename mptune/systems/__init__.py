"""Other actuators under the same load and moves, each giving the neutral record of its run (§7)."""
