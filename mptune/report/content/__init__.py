"""What the report says, as plain data: its chapters, and tables that the terminal prints too."""
