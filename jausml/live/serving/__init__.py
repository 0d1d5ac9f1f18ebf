"""Pages served to browsers: who may ask, requests and answers on a socket, and the server."""
