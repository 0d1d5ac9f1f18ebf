"""ros2jaus, the text language of models: read to models and written from them."""
