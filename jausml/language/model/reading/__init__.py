"""Reading of models: nodes of any notation to elements, with every problem placed."""
