"""What an instruction comes to in one picture: goals, each a thing and where it should be."""
