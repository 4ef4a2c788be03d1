"""What a person did on the page, and the way back."""
