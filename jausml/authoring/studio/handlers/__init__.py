"""What pages ask: one module for each kind of question, with its methods."""
