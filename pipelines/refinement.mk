# make adaptive: what an estimate of the discretisation error is worth on 39 runs with known answers, and error against nodes and time on meshes refined evenly and where the estimate says so
#
# Effectivity: estimated over true mean error at the nodes, for the meshes of make convergence, each beside one of twice the size
# (effectivity.tsv). Refinement: blocks, Cook's membrane, the brain section and the cube by pipelines/refine from one coarse mesh on, graded
# and even; the true mean is taken over places that lie evenly in the body (refinement.tsv).
#
# References, meshes and scenes are those of make convergence, whose file make reads before this one; the brain section's is the one that is fine at the ends of the craniotomy.

ADAPTIVE := $(OUT)/adaptive
ADAPTIVE_CASES := block10 block20 cook brain cube
ADAPTIVE_EFFECTIVITY := block10 block20 block20_4999 block10_graded cook brain cube cube_4999 cube_graded cylinder_3 cylinder_49
cylinder_3.mesh := cylinder
cylinder_49.mesh := cylinder
cylinder.geometry := examples/hard/cylinder.geo
cylinder.gmsh = -setnumber n $(1)
cylinder.unit := m
# Sizes of the runs of the estimate: where a mesh of twice the size is none, or folds, it begins finer.
cube.estimated := 0.021 0.0155 0.011
cylinder.estimated := 8 16 32
adaptive_sizes = $(or $($($(1).mesh).estimated),$($($(1).mesh).sizes))

# Of the refinement: the size that it begins with, the tolerance, about what the reference is uncertain by, the budget of nodes, and the
# least size.
block10.begin := 0.0113
block20.begin := 0.0113
cook.begin := 5.6
brain.begin := 14.6
cube.begin := 0.03
block10.until := 0.005mm
block20.until := 0.02mm
cook.until := 0.3mm
brain.until := 0.01mm
cube.until := 0.1mm
block10.least := 0.4mm
block20.least := 0.4mm
cook.least := 1mm
brain.least := 0.2mm
cube.least := 2mm
cube.budget := 5000
ADAPTIVE_BUDGET := 6000

.PHONY: adaptive
adaptive: $(ADAPTIVE)/effectivity.tsv $(ADAPTIVE)/effectivity-summary.tsv $(ADAPTIVE)/refinement.tsv $(ADAPTIVE)/refinement.png
	@awk -F '\t' '{ printf "%-14s %-8s %7s %9s %9s %12s %12s %7s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7, $$8 }' $< $(word 3,$^)
	@cat $(word 2,$^)

$(ADAPTIVE)/%: export PATH := $(abspath $(BUILD))/bin:$(PATH)

ADAPTIVE_PROGRAMS := $(addprefix $(BUILD)/bin/,nodes ipoints support shapefn mtled fieldcmp fielderr sizefield interp cloud)
ADAPTIVE_SCRIPTS := pipelines/adaptive/rounds.sh pipelines/refine/refine.sh

# References at the nodes, and at places that lie evenly.
$(ADAPTIVE)/brain.ref: examples/brain2d/brain2d_graded.tsv pipelines/reference.awk
	@mkdir -p $(@D)
	awk -f pipelines/reference.awk $< > $@
$(ADAPTIVE)/cylinder_%.ref: pipelines/adaptive/cylinder.awk
	@mkdir -p $(@D)
	awk -v nu=0.$* -f $< > $@
$(ADAPTIVE)/brain.even: $(ADAPTIVE)/brain.ref $(CONVERGENCE)/brain.reference.dat | $(ADAPTIVE_PROGRAMS)
	interp -f u --skip-outside -p $(word 2,$^) $< > $@
$(ADAPTIVE)/cube.even: $(CONVERGENCE)/cube.reference.dat | $(ADAPTIVE_PROGRAMS)
	@mkdir -p $(@D)
	cloud -d 3 -k regular -n 17 --box 0,0.1,0,0.1,0,0.1 | interp -f u -p - $< > $@
adaptive_reference = $(if $(filter brain cylinder_%,$(1)),$(ADAPTIVE)/$(1).ref,$(CONVERGENCE)/$(1).reference.dat)
adaptive_even = $(if $(filter brain cube,$(1)),$(ADAPTIVE)/$(1).even,$(CONVERGENCE)/$(1).reference.dat)
adaptive_gmsh = $(filter-out -2 -3,$(call $($(1).mesh).gmsh,$(2)))

# CASE, SIZE
define ADAPTIVE_RUN
$(ADAPTIVE)/$(1)-$(2).row: $(CONVERGENCE_INPUT)/$(1).scene $($($(1).mesh).geometry) $(call adaptive_reference,$(1)) $(ADAPTIVE_SCRIPTS) | $(ADAPTIVE_PROGRAMS)
	@mkdir -p $$(@D)
	UNIT=$($($(1).mesh).unit) ROUNDS=1 GMSH='$(call adaptive_gmsh,$(1),$(2))' bash pipelines/adaptive/rounds.sh $(1) $(2) \
	    $$(wordlist 1,2,$$^) 1um $$(word 3,$$^) nodes $$(@:.row=) > $$@
endef
$(foreach c,$(ADAPTIVE_EFFECTIVITY),$(foreach s,$(call adaptive_sizes,$(c)),$(eval $(call ADAPTIVE_RUN,$(c),$(s)))))

# CASE, graded or even
define ADAPTIVE_REFINEMENT
$(ADAPTIVE)/$(1)-$(2).row: $(CONVERGENCE_INPUT)/$(1).scene $($($(1).mesh).geometry) $(call adaptive_even,$(1)) $(ADAPTIVE_SCRIPTS) | $(ADAPTIVE_PROGRAMS)
	@mkdir -p $$(@D)
	UNIT=$($($(1).mesh).unit) GRADED=$(if $(filter even,$(2)),no,yes) NODES=$(or $($(1).budget),$(ADAPTIVE_BUDGET)) LEAST=$($(1).least) \
	    GMSH='$(call adaptive_gmsh,$(1),$($(1).begin))' bash pipelines/adaptive/rounds.sh $(1) $(2) $$(wordlist 1,2,$$^) $($(1).until) \
	    $$(word 3,$$^) even $$(@:.row=) > $$@
endef
$(foreach c,$(ADAPTIVE_CASES),$(foreach k,even graded,$(eval $(call ADAPTIVE_REFINEMENT,$(c),$(k)))))

$(ADAPTIVE)/effectivity.tsv: $(foreach c,$(ADAPTIVE_EFFECTIVITY),$(foreach s,$(call adaptive_sizes,$(c)),$(ADAPTIVE)/$(c)-$(s).row))
	(printf 'case\tsize\tnodes\tseconds\tall_seconds\testimate_mm\terror_mm\teffectivity\n'; cat $^) > $@

$(ADAPTIVE)/effectivity-summary.tsv: $(ADAPTIVE)/effectivity.tsv
	awk -F '\t' -v OFS='\t' 'NR > 1 { n++; e = $$8; within += e >= 0.5 && e <= 2; sum += log(e); if (n == 1 || e < least) least = e; if (e > most) most = e } \
	    END { print "runs", "within .5 and 2", "least", "geometric mean", "largest"; printf "%d\t%d\t%.2f\t%.2f\t%.2f\n", n, within, least, exp(sum / n), most }' $< > $@

$(ADAPTIVE)/refinement.tsv: $(foreach c,$(ADAPTIVE_CASES),$(foreach k,even graded,$(ADAPTIVE)/$(c)-$(k).row))
	(printf 'case\tmesh\tnodes\tseconds\tall_seconds\testimate_mm\terror_mm\teffectivity\n'; cat $^) > $@

$(ADAPTIVE)/refinement.png: $(ADAPTIVE)/refinement.tsv pipelines/adaptive/picture.gp
	gnuplot -e "data='$<'; cases='$(ADAPTIVE_CASES)'; out='$@'" pipelines/adaptive/picture.gp
