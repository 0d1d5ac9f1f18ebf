"""The Python interface of jausml, which `import jausml` offers: models, messages, components."""
