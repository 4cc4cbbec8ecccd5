"""What `asv` tracks over versions (asv.conf.json)."""
