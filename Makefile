# tribo: contact and friction between rigid bodies.
#
#   make                 library (shared, static, pkg-config file) and program, into $(BUILD)
#   make lib             both libraries; libtribo needs libccd, Qhull and SuiteSparse
#   make core            libtribo_core alone; needs a C99 compiler and libm
#   make install         into $(DESTDIR)$(PREFIX); uninstall takes it all away again
#   make demo            run the program's demonstration
#   make check           build and run all tests; last line: "tests: N passed, M failed, K skipped"
#   make check-sanitize  the same programs under AddressSanitizer and UBSan, and a clang build
#   make bench           nanoseconds per call, next to the error; other libraries beside
#                        (ODE, Bullet, Box3D by cargo, MuJoCo by pip; Siconos), as far as they are
#                        there. Recorded problems are taken from TRIBO_DATA. A solve beside Siconos
#                        has TRIBO_BENCH_SECONDS=1, a run of a scene in time 2; FULL=1 has 20 and
#                        60, and more sizes and repetitions elsewhere
#   make fuzz            TIME=60 seconds for each fuzz target; ENGINE=libfuzzer or afl
#   make deps            install the Debian packages that demo and check need (both do so anyway)
#   make check-bindings  build and test the bindings whose toolchains are there; part of check
#   make bench-bindings  what a call costs in each language
#   make abi golden      write the goldens of tests/abi, tests/golden and bindings anew
#   make docs format format-check clean
#
# Variables: PREFIX DESTDIR BUILD CC CFLAGS CPPFLAGS LDFLAGS, WERROR=1 (warnings are errors), V=1
# (show commands), V4_WIDTH (vector width in bits that the x86-64-v4 lanes prefer: 256 or 512).
# Use one BUILD folder per set of flags: a change of compiler or flags rebuilds all that is in it.

PREFIX ?= /usr/local
DESTDIR ?=
BUILD ?= build
ifeq ($(origin CC),default)
CC := gcc
endif
CFLAGS ?= -O3 -g
CPPFLAGS ?=
LDFLAGS ?=
V4_WIDTH ?= 512
JOBS ?= 2
TIME ?= 60
ENGINE ?= libfuzzer

prefix = $(PREFIX)
exec_prefix = $(prefix)
bindir = $(exec_prefix)/bin
libdir = $(exec_prefix)/lib
includedir = $(prefix)/include
pkgconfigdir = $(libdir)/pkgconfig
INSTALL ?= install
INSTALL_PROGRAM ?= $(INSTALL)
INSTALL_DATA ?= $(INSTALL) -m 644

.DEFAULT_GOAL := all
.DELETE_ON_ERROR:
.SUFFIXES:
.PHONY: all lib core install uninstall demo check run-check check-sanitize check-bindings \
        run-properties test-programs fuzz fuzz-targets bench bench-bindings bench-programs peers deps abi \
        golden docs format format-check clean help FORCE
ifneq ($(V),1)
.SILENT:
endif

# ---- flags ---------------------------------------------------------------------------------------

# The promise of equal bits is kept by these flags. They come after the user's, so that CFLAGS can
# not drop them, and value-changing flags are refused, at linking too: they turn subnormals off.
# Where the machine has fused multiply-adds, gcc 12 makes them of vectorised a*b+c, a*b-c pairs in
# spite of -ffp-contract=off; that is why straight-line code is not vectorised and FMA is not used.
FP := -ffp-contract=off -fno-math-errno -fno-trapping-math -fno-tree-slp-vectorize
WARN := -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wdouble-promotion -Wstrict-prototypes \
        -Wmissing-prototypes -Wvla -Wundef $(if $(filter 1,$(WERROR)),-Werror)
UNSAFE := $(filter -ffast-math -Ofast -funsafe-math-optimizations -fassociative-math \
            -freciprocal-math -ffinite-math-only -fno-signed-zeros,$(CFLAGS) $(CPPFLAGS) $(LDFLAGS))
ifneq ($(UNSAFE),)
$(error $(UNSAFE) would change results: tribo promises the same bits on every platform)
endif

MACROS := $(shell $(CC) $(CPPFLAGS) $(CFLAGS) -dM -E -x c /dev/null 2>/dev/null | \
            grep -oE '__(x86_64|i386)__')
FP += $(if $(MACROS),-mno-fma) $(if $(filter __i386__,$(MACROS)),-msse2 -mfpmath=sse)
COMMON = $(CPPFLAGS) -Iinclude $(CFLAGS) -std=c99 $(WARN) $(FP)
DEPEND = -MMD -MP

# The lanes need the vectoriser, which gcc at -O2 (what distributions set) keeps to simple loops.
LANES_OPTIMIZE := $(if $(filter -O0 -O1 -Og,$(CFLAGS)),,-O3)

# ---- the library ---------------------------------------------------------------------------------

version_part = $(shell awk '$$2 == "TRIBO_VERSION_$(1)" { print $$3 }' include/tribo/base.h)
MAJOR := $(call version_part,MAJOR)
VERSION := $(MAJOR).$(call version_part,MINOR).$(call version_part,PATCH)
ifneq ($(words $(subst ., ,$(VERSION))),3)
$(error include/tribo/base.h does not state the version)
endif

HEADERS := $(wildcard include/tribo/*.h)
CPP_HEADER := bindings/cpp/include/tribo/tribo.hpp
# What libtribo adds to libtribo_core: shapes and their contacts, sparse factorisations.
FULL := broad clip closed collide convex dissect hull mesh scene scene_contact scene_event \
        scene_rest scene_save scene_solve scene_step scene_weight shape sparse
FULL_SOURCES := $(FULL:%=src/%.c)
FULL_LIBS := -lccd -lqhull_r -lcholmod -lklu -lumfpack -lsuitesparseconfig
# Compiled once per instruction set.
LANES_SOURCES := $(wildcard src/*_lanes.c)
LIB_SOURCES := $(filter-out $(LANES_SOURCES) $(FULL_SOURCES),$(wildcard src/*.c))
LANES := baseline
ifneq ($(filter __x86_64__,$(MACROS)),)
ifeq ($(shell $(CC) -march=x86-64-v4 -E -x c /dev/null >/dev/null 2>&1 && echo yes),yes)
LANES += x86_64_v3 x86_64_v4
LEVELS := -DTRIBO_HAVE_X86_64_LEVELS=1
endif
endif
LANES_FLAGS_baseline :=
LANES_FLAGS_x86_64_v3 := -march=x86-64-v3
LANES_FLAGS_x86_64_v4 := -march=x86-64-v4 -mprefer-vector-width=$(V4_WIDTH)

LIB_OBJECTS := $(LIB_SOURCES:%.c=$(BUILD)/obj/%.o)
FULL_OBJECTS := $(FULL_SOURCES:%.c=$(BUILD)/obj/%.o)
LANES_OBJECTS := $(foreach level,$(LANES),$(LANES_SOURCES:%.c=$(BUILD)/obj/%.$(level).o))
# One set of objects serves both libraries: the static one can go into the shared objects of others
# (language bindings do that).
LIB_FLAGS = $(COMMON) -DTRIBO_BUILD $(LEVELS) -fPIC -fvisibility=hidden -fno-semantic-interposition

STATIC := $(BUILD)/libtribo_core.a
SHARED := $(BUILD)/libtribo_core.so.$(VERSION)
SONAME := libtribo_core.so.$(MAJOR)
LINKS := $(BUILD)/$(SONAME) $(BUILD)/libtribo_core.so
PC := $(BUILD)/tribo_core.pc
FULL_STATIC := $(BUILD)/libtribo.a
FULL_SHARED := $(BUILD)/libtribo.so.$(VERSION)
FULL_SONAME := libtribo.so.$(MAJOR)
FULL_LINKS := $(BUILD)/$(FULL_SONAME) $(BUILD)/libtribo.so
FULL_PC := $(BUILD)/tribo.pc
# clang leaves the run-time library of a sanitizer to the final link.
DEFS := $(if $(findstring -fsanitize,$(CFLAGS) $(LDFLAGS)),,-Wl,-z,defs)

all: lib $(BUILD)/tribo
core: $(STATIC) $(LINKS) $(PC)
lib: core $(FULL_STATIC) $(FULL_LINKS) $(FULL_PC)

$(LIB_OBJECTS) $(FULL_OBJECTS): $(BUILD)/obj/%.o: %.c $(BUILD)/flags
	@mkdir -p $(@D)
	@echo "  CC      $<"
	$(CC) $(LIB_FLAGS) $(DEPEND) -c -o $@ $<

define lanes_rule
$(LANES_SOURCES:%.c=$(BUILD)/obj/%.$(1).o): $(BUILD)/obj/%.$(1).o: %.c $(BUILD)/flags
	@mkdir -p $$(@D)
	@echo "  CC      $$< ($(1))"
	$$(CC) $$(LIB_FLAGS) $$(LANES_OPTIMIZE) -DTRIBO_LANES=$(1) $$(LANES_FLAGS_$(1)) $$(DEPEND) \
	    -c -o $$@ $$<
endef
$(foreach level,$(LANES),$(eval $(call lanes_rule,$(level))))

$(STATIC): $(LIB_OBJECTS) $(LANES_OBJECTS)
	@echo "  AR      $@"
	rm -f $@
	$(AR) rcs $@ $^

$(SHARED): $(LIB_OBJECTS) $(LANES_OBJECTS) src/tribo_core.map
	@echo "  LD      $@"
	$(CC) $(CFLAGS) $(LDFLAGS) -shared -Wl,-soname,$(SONAME) $(DEFS) -Wl,-Bsymbolic-functions \
	    -Wl,--version-script=src/tribo_core.map -o $@ $(filter %.o,$^) -lm

$(LINKS): $(SHARED)
	ln -sf $(<F) $@

$(FULL_STATIC): $(FULL_OBJECTS)
	@echo "  AR      $@"
	rm -f $@
	$(AR) rcs $@ $^

$(FULL_SHARED): $(FULL_OBJECTS) $(LINKS) src/tribo_core.map
	@echo "  LD      $@"
	$(CC) $(CFLAGS) $(LDFLAGS) -shared -Wl,-soname,$(FULL_SONAME) $(DEFS) \
	    -Wl,-Bsymbolic-functions -Wl,--version-script=src/tribo_core.map -o $@ \
	    $(FULL_OBJECTS) -L$(BUILD) -ltribo_core $(FULL_LIBS) -lm

$(FULL_LINKS): $(FULL_SHARED)
	ln -sf $(<F) $@

# Made at each run, because PREFIX may differ from the last one; touched only if it does.
$(PC) $(FULL_PC): $(BUILD)/%.pc: src/%.pc.in FORCE
	@mkdir -p $(@D)
	sed -e 's|@prefix@|$(prefix)|' -e 's|@exec_prefix@|$(exec_prefix)|' -e 's|@libdir@|$(libdir)|' \
	    -e 's|@includedir@|$(includedir)|' -e 's|@version@|$(VERSION)|' $< >$@.new
	cmp -s $@.new $@ && rm $@.new || mv $@.new $@

# Everything depends on the compiler and its flags. WERROR is not among them: it changes no object.
$(BUILD)/flags: FORCE
	@mkdir -p $(@D)
	{ echo '$(CC) $(CPPFLAGS) $(CFLAGS) $(LDFLAGS) $(FP) $(V4_WIDTH)'; $(CC) --version; } >$@.new
	cmp -s $@.new $@ && rm $@.new || mv $@.new $@

# ---- the program, tests, benches and fuzz targets ------------------------------------------------

CLI_OBJECTS := $(patsubst %.c,$(BUILD)/obj/%.o,$(wildcard src/cli/*.c))
SUPPORT_OBJECTS := $(patsubst %.c,$(BUILD)/obj/%.o,$(wildcard tests/support/*.c))
# Rooms of libtribo and of the program; the targets of all others link libtribo_core alone.
FULL_ROOMS := broad collide scene shape sparse table
FULL_SUPPORT := $(patsubst %,$(BUILD)/obj/%.o,fuzz/support/scenes fuzz/support/shapes \
    tests/support/pairs tests/support/poured)
FUZZ_OBJECTS := $(filter-out $(FULL_SUPPORT),$(SUPPORT_OBJECTS) \
    $(patsubst %.c,$(BUILD)/obj/%.o,$(wildcard fuzz/support/*.c)))
ROOMS := $(patsubst fuzz/%.c,%,$(wildcard fuzz/*.c))
TESTS := $(patsubst tests/%.c,$(BUILD)/tests/%,$(wildcard tests/*.c))
BENCHES := $(patsubst tests/bench/%.c,$(BUILD)/bench/%,$(wildcard tests/bench/*.c))
RANDOMS := $(ROOMS:%=$(BUILD)/fuzz/%-random)
REPLAYS := $(ROOMS:%=$(BUILD)/fuzz/%-replay)
ENGINES := $(ROOMS:%=$(BUILD)/fuzz/%)
FULL_TARGETS := $(foreach suffix,% %-random %-replay,$(FULL_ROOMS:%=$(BUILD)/fuzz/$(suffix)))
APP_OBJECTS := $(sort $(CLI_OBJECTS) $(SUPPORT_OBJECTS) $(FUZZ_OBJECTS) $(FULL_SUPPORT) \
    $(patsubst %.c,$(BUILD)/obj/%.o,$(wildcard tests/*.c tests/bench/*.c fuzz/*.c fuzz/driver/*.c)) \
    $(patsubst %.c,$(BUILD)/obj/%.o,$(wildcard bindings/*.c)))

$(APP_OBJECTS): $(BUILD)/obj/%.o: %.c $(BUILD)/flags
	@mkdir -p $(@D)
	@echo "  CC      $<"
	$(CC) $(COMMON) -Isrc -Itests/support $(FILE_FLAGS) $(DEPEND) -c -o $@ $<

link = mkdir -p $(@D) && echo "  LD      $@" && \
       $(CC) $(CFLAGS) $(LDFLAGS) -o $@ $(filter %.o,$^) $(filter %.a,$^)

$(BUILD)/tribo: $(CLI_OBJECTS) $(FULL_STATIC) $(STATIC)
	$(link) -lcsv $(HDF5_LIBS) $(FULL_LIBS) -lm

# Only the reader of FCLib's files includes libhdf5, and its fuzz target, which writes some. Debian
# keeps the serial one of several apart.
HDF5_SERIAL := $(wildcard /usr/include/hdf5/serial)
HDF5_FLAGS ?= $(HDF5_SERIAL:%=-isystem %)
HDF5_LIBS ?= $(if $(HDF5_SERIAL),-lhdf5_serial,-lhdf5)
$(BUILD)/obj/src/cli/fclib.o $(BUILD)/obj/fuzz/problem.o: FILE_FLAGS = $(HDF5_FLAGS)

$(TESTS): $(BUILD)/tests/%: $(BUILD)/obj/tests/%.o $(SUPPORT_OBJECTS) $(FULL_STATIC) $(STATIC)
	$(link) -lcmocka $(TEST_LIBS) $(FULL_LIBS) -lm

VECTORS := $(BUILD)/bindings/vectors
COST := $(BUILD)/bindings/cost
$(VECTORS) $(COST): $(BUILD)/bindings/%: $(BUILD)/obj/bindings/%.o $(FULL_STATIC) $(STATIC)
	$(link) $(FULL_LIBS) -lm

$(BENCHES): $(BUILD)/bench/%: $(BUILD)/obj/tests/bench/%.o $(SUPPORT_OBJECTS) $(FULL_STATIC) $(STATIC)
	$(link) $(BENCH_LIBS) $(FULL_LIBS) -ldl -lm

$(RANDOMS): $(BUILD)/fuzz/%-random: $(BUILD)/obj/fuzz/%.o $(BUILD)/obj/fuzz/driver/random.o \
    $(FUZZ_OBJECTS) $(STATIC)
	$(link) $(ROOM_LIBS) -lm

$(REPLAYS): $(BUILD)/fuzz/%-replay: $(BUILD)/obj/fuzz/%.o $(BUILD)/obj/fuzz/driver/replay.o \
    $(FUZZ_OBJECTS) $(STATIC)
	$(link) $(ROOM_LIBS) -lm

# OSS-Fuzz and `make fuzz` name the engine: a flag such as -fsanitize=fuzzer, or an archive.
$(ENGINES): $(BUILD)/fuzz/%: $(BUILD)/obj/fuzz/%.o $(FUZZ_OBJECTS) $(STATIC)
	$(link) $(LIB_FUZZING_ENGINE) $(ROOM_LIBS) -lm

# libtribo comes after libtribo_core among the prerequisites, but needs it after itself.
$(FULL_TARGETS): $(FULL_SUPPORT) $(FULL_STATIC)
$(FULL_TARGETS): ROOM_LIBS := $(STATIC) $(FULL_LIBS)

# The rooms of the program's readers are linked with them.
READERS := $(patsubst %,$(BUILD)/obj/src/cli/%.o,cli collide table)
TABLE := $(BUILD)/fuzz/table $(BUILD)/fuzz/table-random $(BUILD)/fuzz/table-replay
$(TABLE): $(READERS)
$(TABLE): ROOM_LIBS += -lcsv
PROBLEM := $(patsubst %,$(BUILD)/obj/src/cli/%.o,cli condense dat fclib problem recorded)
PROBLEMS := $(BUILD)/fuzz/problem $(BUILD)/fuzz/problem-random $(BUILD)/fuzz/problem-replay
$(PROBLEMS): $(PROBLEM)
$(PROBLEMS): ROOM_LIBS := $(HDF5_LIBS)

# The scenes of the program are run by a test.
SCENES := $(filter $(BUILD)/obj/src/cli/scene%.o,$(CLI_OBJECTS)) \
          $(patsubst %,$(BUILD)/obj/src/cli/%.o,cli simbench world)
$(BUILD)/tests/scenes: $(SCENES)

# Siconos is optional: without it, its bench has tribo's own times alone.
SICONOS := $(wildcard /usr/include/siconos/numerics)
$(BUILD)/obj/tests/bench/siconos.o: FILE_FLAGS = $(if $(SICONOS),\
    -DTRIBO_HAVE_SICONOS -isystem $(SICONOS) -isystem $(SICONOS)/..)
$(BUILD)/bench/siconos: $(PROBLEM)
$(BUILD)/bench/siconos: BENCH_LIBS = $(HDF5_LIBS) $(if $(SICONOS),-lsiconos_numerics)

# So are ODE and Box2D, which tests compare scenes with: without them, these are skipped. Box2D is
# in C++.
ODE := $(wildcard /usr/include/ode/ode.h)
$(BUILD)/obj/tests/ode.o: FILE_FLAGS = $(if $(ODE),-DTRIBO_HAVE_ODE)
$(BUILD)/tests/ode: TEST_LIBS = $(if $(ODE),-lode)
CXX ?= g++
BOX2D := $(if $(wildcard /usr/include/box2d/box2d.h),$(shell command -v $(CXX) 2>/dev/null))
BOX2D_OBJECT := $(BUILD)/obj/tests/oracle/box2d.o
$(BUILD)/obj/tests/box2d.o: FILE_FLAGS = -Itests $(if $(BOX2D),-DTRIBO_HAVE_BOX2D)
ifneq ($(BOX2D),)
$(BUILD)/tests/box2d: $(BOX2D_OBJECT)
$(BUILD)/tests/box2d: TEST_LIBS = -lbox2d -lstdc++
endif

$(BOX2D_OBJECT): tests/oracle/box2d.cc $(BUILD)/flags
	@mkdir -p $(@D)
	@echo "  CXX     $<"
	$(CXX) $(CPPFLAGS) $(CFLAGS) -std=c++11 -Wall -Wextra -Wshadow -Wconversion \
	    $(if $(filter 1,$(WERROR)),-Werror) $(DEPEND) -c -o $@ $<

-include $(patsubst %.o,%.d,$(LIB_OBJECTS) $(FULL_OBJECTS) $(LANES_OBJECTS) $(APP_OBJECTS) \
    $(BOX2D_OBJECT))

# ---- install -------------------------------------------------------------------------------------

install: all
	$(INSTALL) -d '$(DESTDIR)$(bindir)' '$(DESTDIR)$(pkgconfigdir)' '$(DESTDIR)$(includedir)/tribo'
	$(INSTALL_PROGRAM) $(BUILD)/tribo '$(DESTDIR)$(bindir)'
	$(INSTALL_DATA) $(HEADERS) $(CPP_HEADER) '$(DESTDIR)$(includedir)/tribo'
	$(INSTALL_DATA) $(STATIC) $(SHARED) $(FULL_STATIC) $(FULL_SHARED) '$(DESTDIR)$(libdir)'
	ln -sf $(notdir $(SHARED)) '$(DESTDIR)$(libdir)/$(SONAME)'
	ln -sf $(notdir $(SHARED)) '$(DESTDIR)$(libdir)/libtribo_core.so'
	ln -sf $(notdir $(FULL_SHARED)) '$(DESTDIR)$(libdir)/$(FULL_SONAME)'
	ln -sf $(notdir $(FULL_SHARED)) '$(DESTDIR)$(libdir)/libtribo.so'
	$(INSTALL_DATA) $(PC) $(FULL_PC) '$(DESTDIR)$(pkgconfigdir)'

uninstall:
	rm -f '$(DESTDIR)$(bindir)/tribo'
	cd '$(DESTDIR)$(pkgconfigdir)' && rm -f $(notdir $(PC) $(FULL_PC))
	cd '$(DESTDIR)$(libdir)' && rm -f $(notdir $(STATIC) $(SHARED) $(LINKS)) \
	    $(notdir $(FULL_STATIC) $(FULL_SHARED) $(FULL_LINKS))
	cd '$(DESTDIR)$(includedir)' && rm -f $(HEADERS:include/%=%) tribo/$(notdir $(CPP_HEADER)) && \
	    rmdir tribo

# ---- demonstration, tests, benches ---------------------------------------------------------------

deps:
	.ci/deps build demo check

demo:
	.ci/deps demo
	$(MAKE) --no-print-directory all
	$(BUILD)/tribo demo --out $(BUILD)/demo

# What takes longest comes first, so that no core is idle while the last one runs.
SLOW := bindings/python/check tests/golden.sh tests/cli.sh tests/golden_shapes.sh \
        bindings/js/check bindings/rust/check bindings/go/check bindings/cpp/check \
        $(addprefix $(BUILD)/,tests/towers fuzz/problem-random tests/system fuzz/scene-random \
            tests/sparse fuzz/system-random tests/scene_needs tests/scenes tests/convex \
            tests/impact_sets tests/solve_sets tests/sweep tests/collide tests/broad)
slow_first = $(filter $(1),$(SLOW)) $(filter-out $(SLOW),$(1))

# What a test may ask of its environment. The paths are absolute; the working folder is this one.
TEST_ENV = CMOCKA_MESSAGE_OUTPUT=TAP BUILD='$(abspath $(BUILD))' SRCDIR='$(CURDIR)' CC='$(CC)' \
           CFLAGS='$(CFLAGS)' CPPFLAGS='$(CPPFLAGS)' LDFLAGS='$(LDFLAGS)'
PROPERTIES = $(abspath $(call slow_first,$(TESTS) $(RANDOMS))) \
             $(foreach room,$(ROOMS),'$(abspath $(BUILD)/fuzz/$(room)-replay) fuzz/corpus/$(room)')

# Each binding has a program `check`: TAP, one line "1..0 # SKIP why" without its toolchain.
BINDINGS := $(wildcard bindings/*/check)

test-programs: lib $(TESTS) $(RANDOMS) $(REPLAYS) $(VECTORS)

check:
	.ci/deps check
	$(MAKE) --no-print-directory all test-programs
	$(MAKE) --no-print-directory run-check

run-check:
	$(TEST_ENV) tests/run -j $(JOBS) -t 900 $(call slow_first,$(wildcard tests/*.sh) $(BINDINGS)) \
	    $(PROPERTIES)

check-bindings:
	.ci/deps check bindings
	$(MAKE) --no-print-directory all $(VECTORS)
	$(TEST_ENV) tests/run -j 1 -t 1800 tests/bindings.sh $(BINDINGS)

run-properties:
	$(TEST_ENV) tests/run -j $(JOBS) $(EXTRA) $(PROPERTIES)

# -g1 has the lines that reports name; the places of variables, which -g adds to the larger code
# here, cost a third of the time to compile.
SANITIZE := -O1 -g1 -fno-omit-frame-pointer -fsanitize=address,undefined,float-cast-overflow \
            -fno-sanitize-recover=all
CLANG ?= clang-16

# What clang makes of tests and benches is never run, and its warnings come before any
# optimisation: only the library and the program are built as a user would.
check-sanitize:
	.ci/deps check
	$(MAKE) --no-print-directory all test-programs BUILD=$(BUILD)/asan CC=gcc CFLAGS='$(SANITIZE)'
	{ echo 1..1; \
	  if ! command -v $(CLANG) >/dev/null; then \
	      echo 'ok 1 # SKIP $(CLANG) is not installed'; \
	  elif $(MAKE) --no-print-directory all BUILD=$(BUILD)/clang CC=$(CLANG) CFLAGS='-O3 -g' \
	          WERROR=1 >$(BUILD)/asan/clang.log 2>&1 && \
	      $(MAKE) --no-print-directory test-programs bench-programs BUILD=$(BUILD)/clang-O0 \
	          CC=$(CLANG) CFLAGS=-O0 WERROR=1 >>$(BUILD)/asan/clang.log 2>&1; then \
	      echo 'ok 1 - $(CLANG) builds all without a warning'; \
	  else \
	      echo 'not ok 1 - $(CLANG) builds all without a warning'; \
	      grep error: $(BUILD)/asan/clang.log | sed 's/^/# /'; \
	  fi; } >$(BUILD)/asan/clang.tap
	$(MAKE) --no-print-directory run-properties BUILD=$(BUILD)/asan CC=gcc CFLAGS='$(SANITIZE)' \
	    EXTRA="'cat $(abspath $(BUILD))/asan/clang.tap'"

bench-programs: $(BENCHES)

# Other libraries, for the benches alone; those that are not there are named as skipped.
peers:
	@echo "  PEERS   $(BUILD)/bench/peers"
	CC='$(CC)' tests/bench/peers/build $(BUILD)/bench/peers

bench:
	.ci/deps bench
	$(MAKE) --no-print-directory bench-programs peers
	set -e; for bench in $(BENCHES); do $$bench $(if $(filter 1,$(FULL)),--full); done

bench-bindings:
	.ci/deps check bindings
	$(MAKE) --no-print-directory all $(COST)
	$(TEST_ENV) bindings/bench

# ---- fuzzing -------------------------------------------------------------------------------------

fuzz-targets: $(ENGINES)

fuzz:
	.ci/deps fuzz
	$(MAKE) --no-print-directory fuzz-$(ENGINE)

.PHONY: fuzz-libfuzzer fuzz-afl
fuzz-libfuzzer: export ASAN_OPTIONS ?= detect_leaks=0
fuzz-libfuzzer:
	$(MAKE) --no-print-directory fuzz-targets BUILD=$(BUILD)/libfuzzer CC=$(CLANG) \
	    CFLAGS='-O1 -g -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all' \
	    LIB_FUZZING_ENGINE=-fsanitize=fuzzer
	bad=; for room in $(ROOMS); do \
	    echo "== $$room, $(TIME) s"; found=$(BUILD)/libfuzzer/found/$$room; mkdir -p $$found; \
	    $(BUILD)/libfuzzer/fuzz/$$room -max_total_time=$(TIME) -print_final_stats=1 -verbosity=0 \
	        -artifact_prefix=$$found- $$found fuzz/corpus/$$room || bad="$$bad $$room"; \
	done; test -z "$$bad" || { echo "fuzz: failures in$$bad"; exit 1; }

fuzz-afl: export AFL_SKIP_CPUFREQ := 1
fuzz-afl: export AFL_I_DONT_CARE_ABOUT_MISSING_CRASHES := 1
fuzz-afl: export AFL_NO_UI := 1
fuzz-afl: # without sanitizers: Debian's afl++ has none of its own, and libFuzzer runs with them
	$(MAKE) --no-print-directory fuzz-targets BUILD=$(BUILD)/afl CC=afl-clang-fast \
	    CFLAGS='-O1 -g' LIB_FUZZING_ENGINE=-fsanitize=fuzzer
	bad=; for room in $(ROOMS); do \
	    echo "== $$room, $(TIME) s"; found=$(BUILD)/afl/found/$$room; \
	    rm -rf $$found; mkdir -p $$found; \
	    afl-fuzz -V $(TIME) -i fuzz/corpus/$$room -o $$found $(BUILD)/afl/fuzz/$$room \
	        >$$found/log 2>&1 || tail $$found/log; \
	    grep -E '^(execs_done|saved_crashes|saved_hangs|edges_found)' $$found/default/fuzzer_stats && \
	    test -z "$$(ls $$found/default/crashes)" || bad="$$bad $$room"; \
	done; test -z "$$bad" || { echo "fuzz: failures in$$bad"; exit 1; }

# ---- goldens, documentation, style ---------------------------------------------------------------

abi: lib
	$(TEST_ENV) tests/abi.sh --update

golden: $(VECTORS)
	$(TEST_ENV) tests/golden.sh --update
	$(TEST_ENV) tests/bindings.sh --update

docs:
	.ci/deps docs
	@mkdir -p $(BUILD)/docs
	{ cat .doxygen; echo 'OUTPUT_DIRECTORY = $(BUILD)/docs'; echo 'PROJECT_NUMBER = $(VERSION)'; } | \
	    doxygen -

CLANG_FORMAT ?= clang-format-16
C_FILES = $(shell find include src fuzz tests bindings -name '*.[ch]' -not -path '*/build/*' \
            -not -path '*/node_modules/*')

format:
	.ci/deps format
	$(CLANG_FORMAT) -i $(C_FILES)

format-check:
	.ci/deps format
	echo $(C_FILES) | xargs -n 20 -P $(JOBS) $(CLANG_FORMAT) --dry-run --Werror || \
	    { echo "format-check: make format would change these"; exit 1; }

clean:
	rm -rf $(BUILD)

help:
	awk '/^#/ { sub(/^# ?/, ""); print; next } { exit }' Makefile
