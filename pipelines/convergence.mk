# make convergence: error against the size of the triangles, on clamped blocks, Cook's membrane and the brain section, by the founding paper's
# schemes, the default, mixed elements (FreeFEM) and CalculiX
#
# References: the brain section's is that of make brain2d; the others are examples/convergence/*.tsv, of mixed elements; their heads
# say how good they are. A solution CASE-SCHEME-SIZE has .dat (displacements), .time (see solve.sh), .errors (what fieldcmp prints).
# make speed-error uses them too, and has cases of its own.

CONVERGENCE := $(OUT)/convergence
CONVERGENCE_INPUT := examples/convergence
CONVERGENCE_CASES := block10 block20 block20_4999 cook brain
CONVERGENCE_ALL_CASES := $(CONVERGENCE_CASES) block10_graded cube cube_4999 cube_graded
CONVERGENCE_SCHEMES := mls1 mmls default mixed calculix
# Finer at the rims of the plates, of a part between planes of symmetry.
block10_graded.schemes := default mixed
cube_graded.schemes := default mixed
# CalculiX does not solve all of these.
cube_4999.schemes := mls1 mmls default mixed
schemes = $(or $($(1).schemes),$(CONVERGENCE_SCHEMES))

# Meshes: geometry, unit, sizes, settings of gmsh.
square.geometry := $(CONVERGENCE_INPUT)/square.geo
cook.geometry := examples/hard/cook.geo
brain.geometry := examples/brain2d/brain2d.geo
cube.geometry := $(CONVERGENCE_INPUT)/cube.geo
quarter.geometry := examples/hard/block.geo
eighth.geometry := examples/hard/cube.geo
square.sizes := 0.0113 0.008 0.0056 0.004 0.0028 0.002
# CalculiX needs minutes on these.
calculix.without := 0.0028 0.002 0.0088
cook.sizes := 5.6 4 2.8 2
brain.sizes := 14.6 10.3 7.3 5.2
cube.sizes := 0.03 0.021 0.0155 0.011 0.0088
quarter.sizes := 0.008 0.0056 0.004 0.0028
eighth.sizes := 0.018 0.015 0.0125
square.gmsh = -2 -setnumber h $(1)
cook.gmsh = -2 -setnumber h $(1)
brain.gmsh = -2 -setnumber lc $(1) -setnumber kb 0.72 -setnumber kv 0.58 -setnumber kt 1
cube.gmsh = -3 -setnumber h $(1)
quarter.gmsh = -2 -setnumber h $(1) -setnumber rim 0.3
eighth.gmsh = -3 -setnumber h $(1) -setnumber rim 0.3
square.unit := m
cook.unit := m
brain.unit := mm
cube.unit := m
quarter.unit := m
eighth.unit := m
block10.mesh := square
block20.mesh := square
block20_4999.mesh := square
block10_graded.mesh := quarter
cook.mesh := cook
brain.mesh := brain
cube.mesh := cube
cube_4999.mesh := cube
cube_graded.mesh := eighth

# Tables of the references, and the push where the table is of a part of the body.
block10.reference := $(CONVERGENCE_INPUT)/block10.tsv
block10_graded.reference := $(block10.reference)
block20.reference := $(CONVERGENCE_INPUT)/block20.tsv
block20_4999.reference := $(CONVERGENCE_INPUT)/block20_4999.tsv
cook.reference := $(CONVERGENCE_INPUT)/cook.tsv
brain.reference := examples/brain2d/brain2d_graded.tsv
cube.reference := $(CONVERGENCE_INPUT)/cube.tsv.gz
cube_graded.reference := $(cube.reference)
cube_4999.reference := $(CONVERGENCE_INPUT)/cube_4999.tsv.gz
block10.push := 0.01
block20.push := 0.02
block20_4999.push := 0.02
cube.push := 0.02
cube_4999.push := 0.02

mls1.title := linear MLS (paper)
mmls.title := MMLS (paper)
default.title := default
mixed.title := mixed P2-P1 (FreeFEM)
calculix.title := CalculiX CPE6

.PHONY: convergence convergence-references
convergence: $(CONVERGENCE)/convergence.tsv $(CONVERGENCE)/convergence.png
	@awk -F '\t' '{ printf "%-14s %-20s %9s %7s %9s %9s %7s %7s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7, $$8 }' $<
	$(PICTURES)

$(CONVERGENCE)/%: export PATH := $(abspath $(BUILD))/bin:$(PATH)

# $(call mesh,MESH,SIZE)
define CONVERGENCE_MESH
$(CONVERGENCE)/$(1)-$(2).msh: $($(1).geometry)
	@mkdir -p $$(@D)
	gmsh -v 1 $(call $(1).gmsh,$(2)) -setnumber Mesh.RandomSeed 1 $$< -o $$@
endef
$(foreach m,square cook brain cube quarter eighth,$(foreach s,$($(m).sizes),$(eval $(call CONVERGENCE_MESH,$(m),$(s)))))

# A rebuilt tool does not call for all of it again; `make clean` does.
CONVERGENCE_PROGRAMS := $(addprefix $(BUILD)/bin/,nodes ipoints support shapefn mtled mts fieldcmp)

CONVERGENCE_MIXED := $(wildcard pipelines/mixed/*) $(addprefix pipelines/,stream.awk scene.awk table.awk)

# CASE, SCHEME, SIZE
define CONVERGENCE_SOLUTION
$(CONVERGENCE)/$(1)-$(2)-$(3).time: $(CONVERGENCE_INPUT)/$(1).scene $(CONVERGENCE)/$($(1).mesh)-$(3).msh pipelines/convergence/solve.sh $(if $(filter mixed,$(2)),$(CONVERGENCE_MIXED)) | $(CONVERGENCE_PROGRAMS)
	bash pipelines/convergence/solve.sh $(2) $$(wordlist 1,2,$$^) $($($(1).mesh).unit) $$(@:.time=)
$(CONVERGENCE)/$(1)-$(2)-$(3).errors: $(CONVERGENCE)/$(1)-$(2)-$(3).time $(CONVERGENCE)/$(1).reference.dat
	fieldcmp $$(<:.time=.dat) $$(lastword $$^) > $$@
endef
$(foreach c,$(CONVERGENCE_ALL_CASES),$(foreach m,$(call schemes,$(c)) dolfinx,$(foreach s,$($($(c).mesh).sizes),$(eval $(call CONVERGENCE_SOLUTION,$(c),$(m),$(s))))))

define CONVERGENCE_REFERENCE
$(CONVERGENCE)/$(1).reference.dat: $($(1).reference) pipelines/reference.awk
	@mkdir -p $$(@D)
	gzip -cdf $$< | awk -f pipelines/reference.awk $(addprefix -v push=,$($(1).push)) > $$@
endef
$(foreach c,$(CONVERGENCE_ALL_CASES),$(eval $(call CONVERGENCE_REFERENCE,$(c))))

# All solutions of CASES $(1) as names CASE-SCHEME-SIZE.
convergence_names = $(foreach c,$(1),$(foreach m,$(call schemes,$(c)),$(foreach s,$(filter-out $($(m).without),$($($(c).mesh).sizes)),$(c)-$(m)-$(s))))
CONVERGENCE_NAMES := $(call convergence_names,$(CONVERGENCE_CASES))

$(CONVERGENCE)/convergence.tsv: $(CONVERGENCE_NAMES:%=$(CONVERGENCE)/%.errors) pipelines/convergence/table.awk pipelines/convergence.mk
	awk -f pipelines/convergence/table.awk $(filter %.errors,$^) > $@

$(CONVERGENCE)/convergence.png: $(CONVERGENCE)/convergence.tsv pipelines/convergence/picture.gp
	gnuplot -e "data='$<'; cases='$(CONVERGENCE_CASES)'; out='$@'" pipelines/convergence/picture.gp

# By hand, when a scene changes: minutes. The tables of the blocks by 20 % and of the cube at .49 come from a program outside: on nested
# meshes that are finer at the corner mixed elements find no equilibrium there.
convergence-references: | $(CONVERGENCE_PROGRAMS) $(BUILD)/bin/cloud
	mkdir -p $(CONVERGENCE)
	gmsh -v 1 $(call cook.gmsh,3) $(cook.geometry) -o $(CONVERGENCE)/nested.msh
	PATH=$(abspath $(BUILD))/bin:$$PATH bash pipelines/convergence/reference.sh $(CONVERGENCE_INPUT)/cook.scene $(CONVERGENCE)/nested.msh m > $(CONVERGENCE)/cook.tsv
	gmsh -v 1 $(call quarter.gmsh,0.004) $(quarter.geometry) -o $(CONVERGENCE)/nested.msh
	PATH=$(abspath $(BUILD))/bin:$$PATH cloud -d 2 -k regular -n 65 --box 0,0.05,0,0.05 -o $(CONVERGENCE)/lattice.mts
	PATH=$(abspath $(BUILD))/bin:$$PATH bash pipelines/convergence/reference.sh $(CONVERGENCE_INPUT)/block10_graded.scene $(CONVERGENCE)/nested.msh m \
	    $(CONVERGENCE)/lattice.mts > $(CONVERGENCE)/block10.tsv
	cp $(CONVERGENCE)/cook.tsv $(CONVERGENCE)/block10.tsv $(CONVERGENCE_INPUT)/
