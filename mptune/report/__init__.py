"""The report, as PDF and for the browser."""
