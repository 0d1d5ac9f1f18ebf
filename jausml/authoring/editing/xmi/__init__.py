"""Changes of XMI files: printed as EMF saves them, with comments, encoding and line ends kept."""
