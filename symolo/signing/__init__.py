"""Keys and signatures in the file formats of minisign (https://jedisct1.github.io/minisign/)."""
