# `make demo` and `make test` work on a fresh clone: what is missing is installed, then built.
SCENE = problems/scenes/cr3bp.toml
# Where `make install` installs; the program looks for system files there.
PREFIX = /usr/local

.PHONY: configure build demo test python test-python test-viewer viewer-picture bench debug asan ubsan sanitize fuzz \
	gallery reference format install package packages clean

configure: packages
	@cmake --preset release -DCMAKE_INSTALL_PREFIX=$(abspath $(PREFIX)) -DEXTREMAL_PYTHON=ON >build/configure.log 2>&1 || { \
	  cat build/configure.log; exit 1; }

build: configure
	@cmake --build --preset release

demo: configure
	@cmake --build --preset release --target extremal_app
	@mkdir -p out
	build/release/extremal solve $(SCENE) --output out/demo.json --plot out/demo.svg
	@echo "The plot is out/demo.svg, the numbers are out/demo.json"

test: build
	@ctest --preset release

# The module `extremal`, as built, for build/python/bin/python and, by a file in the folder of the user's own modules,
# for the interpreter of the system. Neither needs to be activated.
PYTHON = /usr/bin/python3
python: configure
	@cmake --build --preset release --target extremal_python
	@$(PYTHON) -m venv --without-pip --system-site-packages build/python
	@for folder in "$$(build/python/bin/python -c 'import sysconfig; print(sysconfig.get_path("purelib"))')" \
	    "$$($(PYTHON) -m site --user-site)"; do \
	  mkdir -p "$$folder" && echo "$(abspath build/release/python)" >"$$folder/extremal.pth" || exit 1; done
	@build/python/bin/python -c 'import extremal; print("import extremal:", extremal.__file__)'

# Tests of the module, its types, and the scripts of problems/python.
test-python: python
	@.ci/packages .ci/python.txt
	@build/python/bin/python -m pytest -q -p no:cacheprovider tests/python
	@build/python/bin/python -m mypy --strict --cache-dir build/mypy build/release/python/extremal
	@build/python/bin/python -m mypy.stubtest --allowlist tests/python/stubs.txt --ignore-unused-allowlist extremal._core

# Pages in Debian's Chromium, by node and npm.
test-viewer: viewer-modules
	@VIEWER_MODULES=build/viewer-tests node --test tests/viewer/

# The picture of a page in README.md.
viewer-picture: viewer-modules
	@mkdir -p out
	@build/release/extremal continue problems/scenes/halo-family.toml --quiet --plot out/halos.html
	@VIEWER_MODULES=build/viewer-tests node tests/viewer/screenshot.mjs out/halos.html problems/pictures/viewer.png \
	  'pause&solution=22&time=0.36' 1280 745

.PHONY: viewer-modules
viewer-modules: configure
	@command -v npm >/dev/null || { echo "Pages are tested by npm and node; install Node.js" >&2; exit 1; }
	@cmake --build --preset release --target extremal_app
	@.ci/packages .ci/viewer.txt
	@mkdir -p build/viewer-tests
	@cp tests/viewer/package.json tests/viewer/package-lock.json tests/viewer/.npmrc build/viewer-tests
	@cd build/viewer-tests && { npm ci --ignore-scripts --prefer-offline >npm.log 2>&1 || { cat npm.log; exit 1; }; }

# Each is a build of its own with all tests.
debug asan ubsan sanitize: packages
	@[ $@ != sanitize ] || .ci/packages .ci/checks.txt
	@cmake --preset $@
	@cmake --build --preset $@
	@ctest --preset $@

asan sanitize fuzz: export ASAN_OPTIONS = detect_leaks=1

# Scenes by libFuzzer for so many seconds, from those of problems/ and from what it kept before; a scene that fails
# is left in build/sanitize/found.
FUZZ_SECONDS = 3600
fuzz: packages
	@.ci/packages .ci/checks.txt
	@cmake --preset sanitize
	@cmake --build --preset sanitize --target fuzz_scene
	@mkdir -p build/sanitize/kept build/sanitize/found
	@build/sanitize/fuzz_scene -max_total_time=$(FUZZ_SECONDS) -timeout=60 -rss_limit_mb=4096 -max_len=4096 -print_funcs=0 -fork=2 \
	  -dict=tests/fuzz/scene.dict -artifact_prefix=build/sanitize/found/ build/sanitize/kept problems/scenes tests/data/refused

bench: build
	@for name in $(filter-out never_wrong data,$(notdir $(patsubst %/,%,$(wildcard bench/*/)))); do \
	  OPENBLAS_NUM_THREADS=1 build/release/bench/bench_$$name || exit 1; done

# Pictures and interactive pages of all scenes, and the page that shows them.
gallery: configure
	@cmake --build --preset release --target extremal_app
	@problems/gallery build/release/extremal

# The tables of keys in problems/README.md.
reference: configure
	@cmake --build --preset release --target test_house
	@EXTREMAL_WRITE_REFERENCE=1 build/release/tests/test_house --gtest_filter='Reference.*'

format:
	@git ls-files -co --exclude-standard '*.hpp' '*.cpp' | xargs clang-format -i

install: build
	@cmake --install build/release

# build/extremal_VERSION_ARCHITECTURE.deb
package: PREFIX = /usr
package: configure
	@cmake --build --preset release --target extremal_pages extremal_python extremal_solve extremal_rivals extremal_study extremal_report
	@cd build/release && cpack -B .. >cpack.log || { cat cpack.log; exit 1; }
	@ls build/*.deb

packages:
	@mkdir -p build
	@.ci/packages

clean:
	@rm -rf build out
