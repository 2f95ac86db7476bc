"""What of arms with more than two joints? Answers about arms of balls, as imported ones are."""
