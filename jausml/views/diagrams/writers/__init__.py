"""Writers of graphs; those of pictures take a layout too."""
