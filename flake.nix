# nix run .           the workbench
# nix build .         result/bin/linden with its manual and completions
# nix develop         what the tests need
#
# nixpkgs is taken by name: `nix flake lock` pins it where linden is packaged. It has to bring Rust 1.95.
{
  description = "Grows trees from L-systems and space colonization and hands them to every 3D pipeline";

  inputs.nixpkgs.url = "github:NixOS/nixpkgs/nixpkgs-unstable";

  outputs = { self, nixpkgs }:
    let
      systems = [ "x86_64-linux" "aarch64-linux" "x86_64-darwin" "aarch64-darwin" ];
      forEach = build: nixpkgs.lib.genAttrs systems (system: build nixpkgs.legacyPackages.${system});
      manifest = (nixpkgs.lib.importTOML ./Cargo.toml).workspace.package;
    in
    {
      packages = forEach (pkgs: {
        default = pkgs.rustPlatform.buildRustPackage {
          pname = "linden";
          inherit (manifest) version;
          src = self;
          cargoLock.lockFile = ./Cargo.lock;
          # For `linden --version` and the files that it writes: the source comes without its repository.
          env.LINDEN_COMMIT = self.shortRev or self.dirtyShortRev or "";
          cargoBuildFlags = [ "--package" "linden-cli" ];
          # Of the program alone: all tests ask for Python, Node.js and a network.
          cargoTestFlags = [ "--package" "linden-base" "--package" "linden-exporters" ];
          nativeBuildInputs = [ pkgs.installShellFiles ];
          # What is built runs here, unless it is built for another machine.
          postInstall = pkgs.lib.optionalString
            (pkgs.stdenv.buildPlatform.canExecute pkgs.stdenv.hostPlatform) ''
            "$out/bin/linden" man -o man1
            installManPage man1/*.1
            installShellCompletion --cmd linden \
              --bash <("$out/bin/linden" completions bash) \
              --zsh <("$out/bin/linden" completions zsh) \
              --fish <("$out/bin/linden" completions fish)
          '';
          meta = {
            inherit (manifest) description;
            license = with pkgs.lib.licenses; [ mit asl20 ];
            mainProgram = "linden";
          };
        };
      });

      devShells = forEach (pkgs: {
        default = pkgs.mkShell {
          inputsFrom = [ self.packages.${pkgs.stdenv.hostPlatform.system}.default ];
          packages = with pkgs; [ cargo-deny clippy rustfmt python3 nodejs tmux ];
        };
      });
    };
}
