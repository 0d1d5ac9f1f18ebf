"""C++17: codecs of messages and translations, printed of the same views and steps as Python's."""
