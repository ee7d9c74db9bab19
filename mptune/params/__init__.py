"""What a study and a gains file say: data only, each value with unit, symbol and source."""
