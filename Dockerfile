# SPDX-License-Identifier: Apache-2.0
# The README's two commands in a container: docker build -t slipwise . && docker run --rm slipwise
FROM debian:12-slim AS tools
RUN apt-get update && apt-get install -y --no-install-recommends ca-certificates g++ git make python3-dev python3-venv \
  && rm -rf /var/lib/apt/lists/*

FROM tools
WORKDIR /slipwise
COPY . .
RUN make demo
CMD ["make", "test"]
