# linden for render farms: one static program on an empty file system, no shell, no root.
#
#   docker build -t linden --build-arg LINDEN_COMMIT="$(git rev-parse --short=7 HEAD)" .
#   docker run --rm -v "$PWD/out:/out" --user "$(id -u):$(id -g)" linden export oak -o oak.glb
#
# packaging/container builds the last stage without Docker and tries it.
FROM rust:1.95-bookworm AS build
WORKDIR /linden
COPY . .
# There is no repository in here: `linden --version` names the commit that is said.
ARG LINDEN_COMMIT=
# The C library inside, so that nothing is asked of what surrounds it. A target must be named for that:
# without one the flag would go to build scripts and procedural macros, too.
RUN --mount=type=cache,target=/usr/local/cargo/registry \
    packaging/static "$(rustc --print host-tuple)" /linden/static

FROM scratch
COPY --from=build /linden/static/linden /usr/bin/linden
COPY --from=build /linden/LICENSE-APACHE /linden/LICENSE-MIT /usr/share/licenses/linden/
# Any other user and folder can be given to `run`. Temporary files lie beside what they become.
USER 65532:65532
WORKDIR /out
ENTRYPOINT ["/usr/bin/linden"]
