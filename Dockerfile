# docker build -t remqa-data . && docker run --rm -v "$PWD/out:/data/out" remqa-data remqa-gen --scenes 12 --out out/remqa
# CPython 3.11, because PyBullet has a wheel for it.
FROM python:3.11-slim-bookworm
# Debian drops old versions of its packages, so they are not pinned.
# hadolint ignore=DL3008
RUN apt-get update && apt-get install -y --no-install-recommends git make && rm -rf /var/lib/apt/lists/*
COPY . /opt/remqa-data
RUN pip install --no-cache-dir --constraint /opt/remqa-data/constraints.txt '/opt/remqa-data[report]'
WORKDIR /data
CMD ["remqa-data", "--help"]
