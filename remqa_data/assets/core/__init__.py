"""What an asset is, and the builder with which the function of an object type draws one."""
