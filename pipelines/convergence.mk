# make convergence: error against the size of the triangles, on clamped blocks, Cook's membrane and the brain section (with its
# skull), by the founding paper's schemes, by the default and by CalculiX, with the orders that are seen.
#
# References: the brain section's is that of make brain2d; the others are examples/convergence/CASE.tsv, by
# pipelines/convergence/reference.sh; their heads say how good they are. A solution
# CASE-SCHEME-SIZE has .dat (displacements), .time (see solve.sh), .errors (what fieldcmp prints). make speed-error uses them too.

CONVERGENCE := $(OUT)/convergence
CONVERGENCE_INPUT := examples/convergence
CONVERGENCE_NESTED := block10 block20 cook
CONVERGENCE_CASES := $(CONVERGENCE_NESTED) brain
CONVERGENCE_SCHEMES := mls1 mmls default calculix

# Meshes: geometry, unit, sizes, what gmsh is told.
square.geometry := $(CONVERGENCE_INPUT)/square.geo
cook.geometry := examples/hard/cook.geo
brain.geometry := examples/brain2d/brain2d.geo
cube.geometry := $(CONVERGENCE_INPUT)/cube.geo
square.sizes := 0.0113 0.008 0.0056 0.004
cook.sizes := 5.6 4 2.8 2
brain.sizes := 14.6 10.3 7.3 5.2
cube.sizes := 0.03 0.021 0.0155 0.011 0.0088
square.gmsh = -2 -setnumber h $(1)
cook.gmsh = -2 -setnumber h $(1)
brain.gmsh = -2 -setnumber lc $(1) -setnumber kb 0.72 -setnumber kv 0.58 -setnumber kt 1
cube.gmsh = -3 -setnumber h $(1)
square.unit := m
cook.unit := m
brain.unit := mm
cube.unit := m
block10.mesh := square
block20.mesh := square
cook.mesh := cook
brain.mesh := brain
cube.mesh := cube

mls1.title := linear MLS (paper)
mmls.title := MMLS (paper)
default.title := default
calculix.title := CalculiX CPE6

.PHONY: convergence convergence-references
convergence: $(CONVERGENCE)/convergence.tsv $(CONVERGENCE)/convergence.png
	@awk -F '\t' '{ printf "%-8s %-20s %9s %7s %9s %9s %7s %7s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7, $$8 }' $<

$(CONVERGENCE)/%: export PATH := $(abspath $(BUILD))/bin:$(PATH)

# $(call mesh,MESH,SIZE)
define CONVERGENCE_MESH
$(CONVERGENCE)/$(1)-$(2).msh: $($(1).geometry)
	@mkdir -p $$(@D)
	gmsh -v 1 $(call $(1).gmsh,$(2)) -setnumber Mesh.RandomSeed 1 $$< -o $$@
endef
$(foreach m,square cook brain cube,$(foreach s,$($(m).sizes),$(eval $(call CONVERGENCE_MESH,$(m),$(s)))))

# A rebuilt tool does not call for all of it again; `make clean` does.
CONVERGENCE_PROGRAMS := $(addprefix $(BUILD)/bin/,nodes ipoints support shapefn mtled mts fieldcmp)

# CASE, SCHEME, SIZE
define CONVERGENCE_SOLUTION
$(CONVERGENCE)/$(1)-$(2)-$(3).time: $(CONVERGENCE_INPUT)/$(1).scene $(CONVERGENCE)/$($(1).mesh)-$(3).msh pipelines/convergence/solve.sh | $(CONVERGENCE_PROGRAMS)
	bash pipelines/convergence/solve.sh $(2) $$(wordlist 1,2,$$^) $($($(1).mesh).unit) $$(@:.time=)
$(CONVERGENCE)/$(1)-$(2)-$(3).errors: $(CONVERGENCE)/$(1)-$(2)-$(3).time $(CONVERGENCE)/$(1).reference.dat
	fieldcmp $$(<:.time=.dat) $$(lastword $$^) > $$@
endef
$(foreach c,$(CONVERGENCE_CASES) cube,$(foreach m,$(CONVERGENCE_SCHEMES),$(foreach s,$($($(c).mesh).sizes),$(eval $(call CONVERGENCE_SOLUTION,$(c),$(m),$(s))))))

$(CONVERGENCE)/brain.reference.dat: examples/brain2d/brain2d_reference.tsv
$(CONVERGENCE_NESTED:%=$(CONVERGENCE)/%.reference.dat): $(CONVERGENCE)/%.reference.dat: $(CONVERGENCE_INPUT)/%.tsv
$(CONVERGENCE_CASES:%=$(CONVERGENCE)/%.reference.dat): pipelines/reference.awk
	@mkdir -p $(@D)
	awk -f pipelines/reference.awk $(filter %.tsv,$^) > $@

# All solutions of CASES $(1) as names CASE-SCHEME-SIZE.
convergence_names = $(foreach c,$(1),$(foreach m,$(CONVERGENCE_SCHEMES),$(foreach s,$($($(c).mesh).sizes),$(c)-$(m)-$(s))))
CONVERGENCE_NAMES := $(call convergence_names,$(CONVERGENCE_CASES))

$(CONVERGENCE)/convergence.tsv: $(CONVERGENCE_NAMES:%=$(CONVERGENCE)/%.errors) pipelines/convergence/table.awk pipelines/convergence.mk
	awk -f pipelines/convergence/table.awk $(filter %.errors,$^) > $@

$(CONVERGENCE)/convergence.png: $(CONVERGENCE)/convergence.tsv pipelines/convergence/picture.gp
	gnuplot -e "data='$<'; cases='$(CONVERGENCE_CASES)'; out='$@'" pipelines/convergence/picture.gp

# By hand, when a scene changes: a few minutes for each case.
block10.nested := 0.005
block20.nested := 0.005
cook.nested := 3
convergence-references: | $(CONVERGENCE_PROGRAMS)
	mkdir -p $(CONVERGENCE)
	$(foreach c,$(CONVERGENCE_NESTED),gmsh -v 1 $(call $($(c).mesh).gmsh,$($(c).nested)) $($($(c).mesh).geometry) -o $(CONVERGENCE)/nested.msh && \
	    PATH=$(abspath $(BUILD))/bin:$$PATH bash pipelines/convergence/reference.sh $(CONVERGENCE_INPUT)/$(c).scene $(CONVERGENCE)/nested.msh $($($(c).mesh).unit) > $(CONVERGENCE)/$(c).tsv && \
	    cp $(CONVERGENCE)/$(c).tsv $(CONVERGENCE_INPUT)/ && ) true
