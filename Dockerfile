# The program with the engine of the live page:
#   docker build -t magsplice .
#   docker run --rm -v "$PWD:/films" magsplice decouple film.toml
FROM rust:1.95.0-slim-trixie AS build
# Debian keeps only the newest version of a package.
# hadolint ignore=DL3008
RUN apt-get update \
    && apt-get install -y --no-install-recommends python3 \
    && rm -rf /var/lib/apt/lists/* \
    && rustup component add rust-src
WORKDIR /source
COPY . .
RUN bash .ci/page-engine --build \
    && MAGSPLICE_PAGE_ENGINE=/source/target/page-engine.wasm.xz \
       cargo install --locked --path crates/cli --root /installed

FROM debian:trixie-slim
COPY --from=build /installed/bin/magsplice /usr/local/bin/magsplice
COPY LICENSE-MIT LICENSE-APACHE /usr/share/doc/magsplice/
RUN useradd --create-home --uid 10001 magsplice
USER 10001
WORKDIR /films
ENTRYPOINT ["magsplice"]
