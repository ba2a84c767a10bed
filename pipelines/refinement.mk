# make adaptive: what an estimate of the discretisation error is worth on runs with known answers, and error against nodes and time on meshes refined evenly and where the estimate says so
#
# Effectivity: estimated over true mean error at the nodes, for the meshes of make convergence, each beside one of twice the size
# (effectivity.tsv). Refinement: blocks, Cook's membrane, the brain section, the cube, a thick cylinder (smooth) and the whole brain (without its
# skull) by pipelines/refine from one coarse mesh on, graded and even, and by mixed elements (FreeFEM) on meshes graded by their own solution, and even;
# the true mean is taken over places that lie evenly in the body (refinement.tsv). What each needs to given errors: reach.tsv. Tolerances
# that make refine reached unattended, beside the true error: unattended.tsv.
#
# References, meshes and scenes are those of make convergence, whose file make reads before this one; the brain section's is the one that is fine at the ends of the craniotomy.

ADAPTIVE := $(OUT)/adaptive
ADAPTIVE_CASES := block10 block20 cook brain cube cylinder_49 brain3d
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

# The refinement begins with one size throughout: the geometry's own sizes, twice as large outside, are as good as graded.
cylinder_49.uniform := -setnumber ratio 1

# Of the refinement: the size that it begins with, the tolerance, about what the reference is uncertain by, the budget of nodes (of the brain section
# that of make refine), and the least size.
block10.begin := 0.0113
block20.begin := 0.0113
cook.begin := 5.6
brain.begin := 14.6
cube.begin := 0.03
cylinder_49.begin := 5
brain3d.begin := 13.8
block10.until := 0.005mm
block20.until := 0.02mm
cook.until := 0.3mm
brain.until := 0.01mm
cube.until := 0.05mm
cylinder_49.until := 1e-11
brain3d.until := 0.1mm
block10.least := 0.4mm
block20.least := 0.4mm
cook.least := 1mm
brain.least := 0.2mm
cube.least := 1mm
brain3d.least := 1mm
brain.budget := 20000
cube.budget := 8000
cube.even_budget := 24000
brain3d.budget := 16000
# The whole brain beside its surfaces (brain3d.mk), without the skull, which mixed elements in 3D do not know.
brain3d.mesh := brain3d
brain3d.geometry := $(BRAIN3D)/brain3d.geo
brain3d.gmsh = -setnumber lc $(1)
brain3d.unit := mm
brain3d.input := examples/brain3d/free.scene
adaptive_scene = $(or $($(1).input),$(CONVERGENCE_INPUT)/$(1).scene)
# Mixed elements: the budget, of nodes and middles of edges, the share of the error wanted of a round, and how far facets may be off a curve.
block10.mixed := 4000
block20.mixed := 4000
cook.mixed := 6000
brain.mixed := 9000
brain.sag := 0.01mm
cube.mixed := 19000
brain3d.mixed := 20000
# Errors, mm, for reach.tsv: of the blocks, down to 0.1 % of the largest displacement, 0.05 % of that by 10 %; of the cube 0.3 % last.
ADAPTIVE_LEVELS := block10:0.02 block10:0.01 block10:0.005 block20:0.04 block20:0.02 cook:1 cook:0.5 brain:0.03 brain:0.02 brain:0.01 cube:0.2 cube:0.12 \
    cube:0.06 cylinder_49:1e-7 cylinder_49:3e-8 brain3d:0.1
ADAPTIVE_BUDGET := 6000

.PHONY: adaptive
adaptive: $(ADAPTIVE)/effectivity.tsv $(ADAPTIVE)/effectivity-summary.tsv $(ADAPTIVE)/refinement.tsv $(ADAPTIVE)/reach.tsv $(ADAPTIVE)/unattended.tsv $(ADAPTIVE)/refinement.png
	@awk -F '\t' '{ printf "%-14s %-8s %7s %9s %9s %12s %12s %7s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7, $$8 }' $< $(word 3,$^)
	@cat $(word 2,$^)
	@awk -F '\t' '{ printf "%-12s %8s %10s %12s %11s %8s %8s %12s %14s %12s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7, $$8, $$9, $$10 }' $(word 4,$^)
	@cat $(word 5,$^)
	$(PICTURES)

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
# The brain's places are those of a mesh that is not finer at the ends of the craniotomy, as the reference is.
$(ADAPTIVE)/brain.even: $(ADAPTIVE)/brain.ref examples/brain2d/brain2d_reference.tsv pipelines/reference.awk | $(ADAPTIVE_PROGRAMS)
	awk -f pipelines/reference.awk $(word 2,$^) | interp -f u --skip-outside -p - $< > $@
$(ADAPTIVE)/cube.even: $(CONVERGENCE)/cube.reference.dat | $(ADAPTIVE_PROGRAMS)
	@mkdir -p $(@D)
	cloud -d 3 -k regular -n 17 --box 0,0.1,0,0.1,0,0.1 | interp -f u -p - $< > $@
adaptive_reference = $(if $(filter brain cylinder_%,$(1)),$(ADAPTIVE)/$(1).ref,$(CONVERGENCE)/$(1).reference.dat)
adaptive_even = $(or $($(1).even),$(if $(filter brain cube,$(1)),$(ADAPTIVE)/$(1).even,$(CONVERGENCE)/$(1).reference.dat))
brain3d.even := $(BRAIN3D)/reference.dat
cylinder_49.even := $(ADAPTIVE)/cylinder_49.ref
# Times are the least of three runs where a run takes a second or two.
adaptive_repeat = $(if $(filter cube brain3d,$(1)),1,3)
adaptive_gmsh = $(filter-out -2 -3,$(call $($(1).mesh).gmsh,$(2)))

# CASE, SIZE
define ADAPTIVE_RUN
$(ADAPTIVE)/$(1)-$(2).row: $(CONVERGENCE_INPUT)/$(1).scene $($($(1).mesh).geometry) $(call adaptive_reference,$(1)) $(ADAPTIVE_SCRIPTS) | $(ADAPTIVE_PROGRAMS)
	@mkdir -p $$(@D)
	ORDER= UNIT=$($($(1).mesh).unit) ROUNDS=1 GMSH='$(call adaptive_gmsh,$(1),$(2))' bash pipelines/adaptive/rounds.sh $(1) $(2) \
	    $$(wordlist 1,2,$$^) 1um $$(word 3,$$^) nodes $$(@:.row=) > $$@
endef
$(foreach c,$(ADAPTIVE_EFFECTIVITY),$(foreach s,$(call adaptive_sizes,$(c)),$(eval $(call ADAPTIVE_RUN,$(c),$(s)))))

# CASE, graded or even
define ADAPTIVE_REFINEMENT
$(ADAPTIVE)/$(1)-$(2).row: $(call adaptive_scene,$(1)) $($($(1).mesh).geometry) $(call adaptive_even,$(1)) $(ADAPTIVE_SCRIPTS) $(if $(filter brain3d,$(1)),$(BRAIN3D)/brain3d_surfaces.msh) | $(ADAPTIVE_PROGRAMS)
	@mkdir -p $$(@D)
	UNIT=$($($(1).mesh).unit) GRADED=$(if $(filter even,$(2)),no,yes) NODES=$(or $($(1).$(2)_budget),$($(1).budget),$(ADAPTIVE_BUDGET)) REPEAT=$(call adaptive_repeat,$(1)) LEAST=$($(1).least) \
	    GMSH='$(call adaptive_gmsh,$(1),$($(1).begin)) $($(1).uniform)' bash pipelines/adaptive/rounds.sh $(1) $(2) $$(wordlist 1,2,$$^) $($(1).until) \
	    $$(word 3,$$^) even $$(@:.row=) > $$@

$(ADAPTIVE)/$(1)-mixed-$(2).row: $(call adaptive_scene,$(1)) $($($(1).mesh).geometry) $(call adaptive_even,$(1)) pipelines/adaptive/mixed.sh $(CONVERGENCE_MIXED) $(if $(filter brain3d,$(1)),$(BRAIN3D)/brain3d_surfaces.msh) | $(ADAPTIVE_PROGRAMS)
	@mkdir -p $$(@D)
	UNIT=$($($(1).mesh).unit) BUDGET=$($(1).mixed) REPEAT=$(call adaptive_repeat,$(1)) SHARE=0.5 SAG=$($(1).sag) GMSH='$(call adaptive_gmsh,$(1),$($(1).begin))' \
	    bash pipelines/adaptive/mixed.sh $(1) $(2) $$(wordlist 1,3,$$^) $$(@:.row=) > $$@
endef
$(foreach c,$(ADAPTIVE_CASES),$(foreach k,even graded,$(eval $(call ADAPTIVE_REFINEMENT,$(c),$(k)))))

$(ADAPTIVE)/effectivity.tsv: $(foreach c,$(ADAPTIVE_EFFECTIVITY),$(foreach s,$(call adaptive_sizes,$(c)),$(ADAPTIVE)/$(c)-$(s).row))
	(printf 'case\tsize\tnodes\tseconds\tall_seconds\testimate_mm\terror_mm\teffectivity\n'; cat $^) > $@

$(ADAPTIVE)/effectivity-summary.tsv: $(ADAPTIVE)/effectivity.tsv
	awk -F '\t' -v OFS='\t' 'NR > 1 { n++; e = $$8; within += e >= 0.5 && e <= 2; sum += log(e); if (n == 1 || e < least) least = e; if (e > most) most = e } \
	    END { print "runs", "within .5 and 2", "least", "geometric mean", "largest"; printf "%d\t%d\t%.2f\t%.2f\t%.2f\n", n, within, least, exp(sum / n), most }' $< > $@

# Mixed elements know no pressure of the scene, which the cylinder has; graded they are not asked for the whole brain.
adaptive_mixed = $(if $(filter cylinder_49,$(1)),,mixed-even $(if $(filter brain3d,$(1)),,mixed-graded))

$(ADAPTIVE)/refinement.tsv: $(foreach c,$(ADAPTIVE_CASES),$(foreach k,even graded $(call adaptive_mixed,$(c)),$(ADAPTIVE)/$(c)-$(k).row))
	(printf 'case\tmesh\tnodes\tseconds\tall_seconds\testimate_mm\terror_mm\teffectivity\n'; cat $^) > $@

$(ADAPTIVE)/reach.tsv: $(ADAPTIVE)/refinement.tsv pipelines/adaptive/reach.awk pipelines/refinement.mk
	awk -v levels='$(ADAPTIVE_LEVELS)' -f pipelines/adaptive/reach.awk $< > $@

# The last round of each: rounds, the estimate, and the true error, which confirms it where it is below the tolerance, too.
$(ADAPTIVE)/unattended.tsv: $(ADAPTIVE)/refinement.tsv pipelines/refinement.mk
	awk -F '\t' -v OFS='\t' -v wanted='$(foreach c,brain brain3d,$(c):$($(c).until))' ' \
	    BEGIN { n = split(wanted, w, " "); for (i = 1; i <= n; i++) { split(w[i], p, ":"); name[i] = p[1]; until[p[1]] = p[2] + 0 } } \
	    $$2 == "graded" && $$1 in until { rounds[$$1]++; nodes[$$1] = $$3; all[$$1] = $$5; estimate[$$1] = $$6; error[$$1] = $$7 } \
	    END { print "case", "tolerance_mm", "rounds", "nodes", "all_seconds", "estimate_mm", "error_mm", "reached", "confirmed"; \
	        for (i = 1; i <= n; i++) { c = name[i]; print c, until[c], rounds[c], nodes[c], all[c], estimate[c], error[c], \
	            (estimate[c] <= until[c] ? "yes" : "no"), (error[c] <= until[c] ? "yes" : "no") } }' $< > $@

$(ADAPTIVE)/refinement.png: $(ADAPTIVE)/refinement.tsv pipelines/adaptive/picture.gp
	gnuplot -e "data='$<'; cases='$(ADAPTIVE_CASES)'; out='$@'" pipelines/adaptive/picture.gp
