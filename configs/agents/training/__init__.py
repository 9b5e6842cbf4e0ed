"""Networks of `remqa-agent train` that come with the package: `remqa-agent train detector`."""
