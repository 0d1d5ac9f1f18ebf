"""Changes of XMI: what is planned keeps quotes, layout, comments, encoding and line ends."""
