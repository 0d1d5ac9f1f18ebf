"""Views of message codecs: what templates may ask about a message class and its fields."""
