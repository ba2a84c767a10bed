# make gallery: examples that others can judge, each with a picture: a liver (make liver), a bar of silicone whose bending was
# measured (make phantom), and a probe pressed into tissue beside Hertz (make indentation).

GALLERY := $(OUT)/gallery
LIVER := examples/liver
PHANTOM := examples/phantom
PHANTOM_SIZES := 3.5 2.5 1.8
GALLERY_PROGRAMS := $(addprefix $(BUILD)/bin/,nodes tag ipoints support shapefn mtled mts)
GALLERY_LOG = 2> $(@:.dat=.log) || { cat $(@:.dat=.log) >&2; false; }

.PHONY: gallery liver phantom indentation
gallery: liver phantom indentation

$(GALLERY)/%: export PATH := $(abspath $(BUILD))/bin:$(PATH)

# ---- liver -----------------------------------------------------------------------------------------------------------

liver: $(GALLERY)/liver.png
	@grep -E '^(steps|estimated error|least J)' $(GALLERY)/liver.log
	$(PICTURES)

$(GALLERY)/liver_surface.stl: $(LIVER)/liver_surface.stl.gz
	@mkdir -p $(@D)
	gzip -dc $< > $@

# The geometry merges the surface beside it.
$(GALLERY)/liver.msh: $(LIVER)/liver.geo $(GALLERY)/liver_surface.stl
	cp $< $(@:.msh=.geo)
	gmsh -3 -nt 1 -v 2 $(@:.msh=.geo) -o $@

$(GALLERY)/liver.dat: $(GALLERY)/liver.msh $(LIVER)/liver.scene $(GALLERY_PROGRAMS)
	(nodes -u mm $< | tag -f 'held=normal:0,1,0,50 and box:0,0,0.11,0.17,1,0.18' -f 'tip=high:x,6%' | \
	    shapefn | mtled -v $(LIVER)/liver.scene) > $@ $(GALLERY_LOG)

GALLERY_BODY3D := awk -f pipelines/stream.awk -f pipelines/plot/body3d.awk

$(GALLERY)/liver.png: $(GALLERY)/liver.dat pipelines/stream.awk pipelines/plot/body3d.awk pipelines/plot/body3d.gp
	$(GALLERY_BODY3D) -v field=$< -v view=0.3,-1,0.25 -v most=30 > $(@:.png=.whole)
	$(GALLERY_BODY3D) -v field=$< -v view=0.3,-1,0.25 -v most=30 -v cut=0,-1,0,-85 > $(@:.png=.part)
	gnuplot -e "whole='$(@:.png=.whole)'; part='$(@:.png=.part)'; most=30; out='$@'; \
	    title='Left lobe lifted by 32 mm; blue: outline before'; second='the same, cut'" pipelines/plot/body3d.gp

# ---- phantom ---------------------------------------------------------------------------------------------------------

phantom: $(GALLERY)/phantom.tsv $(GALLERY)/phantom.png
	@awk -F '\t' '{ printf "%-28s %6s %10s %10s %8s\n", $$1, $$2, $$3, $$4, $$5 }' $<
	$(PICTURES)

$(PHANTOM_SIZES:%=$(GALLERY)/phantom-%.dat): $(GALLERY)/phantom-%.dat: $(PHANTOM)/beam.geo $(PHANTOM)/beam.scene $(GALLERY_PROGRAMS)
	@mkdir -p $(@D)
	gmsh -3 -nt 1 -v 2 $< -setnumber h $* -o $(@:.dat=.msh)
	(nodes -u mm $(@:.dat=.msh) | shapefn | mtled -v $(PHANTOM)/beam.scene) > $@ $(GALLERY_LOG)

$(PHANTOM_SIZES:%=$(GALLERY)/phantom-%.rows): %.rows: %.dat pipelines/gallery/tip.awk
	awk -f pipelines/stream.awk -f pipelines/gallery/tip.awk -v field=$< > $@

$(GALLERY)/phantom.tsv: $(PHANTOM_SIZES:%=$(GALLERY)/phantom-%.rows) pipelines/gallery.mk
	(printf 'quantity\tnodes\tours\treference\tratio\n'; cat $(filter %.rows,$^)) > $@

$(GALLERY)/phantom.png: $(GALLERY)/phantom-2.5.dat pipelines/gallery/phantom.gp
	paste <(mts print nodes.x $<) <(mts print u $<) > $(@:.png=.plot)
	gnuplot -e "data='$(@:.png=.plot)'; out='$@'" pipelines/gallery/phantom.gp

# ---- indentation -----------------------------------------------------------------------------------------------------

indentation: $(GALLERY)/indentation.tsv $(GALLERY)/indentation.png
	@cat $<
	$(PICTURES)

$(GALLERY)/indentation.dat: examples/indentation/tissue.geo examples/indentation/indentation.scene examples/indentation/probe.tsv $(GALLERY_PROGRAMS)
	@mkdir -p $(@D)
	gmsh -3 -nt 1 -v 2 $< -o $(@:.dat=.msh)
	(nodes -u mm $(@:.dat=.msh) | tag -f 'probed=ball:0,0,0,0.0045 and normal:0,0,1,10' | shapefn | \
	    mtled -v examples/indentation/indentation.scene) > $@ $(GALLERY_LOG)

$(GALLERY)/indentation.tsv: $(GALLERY)/indentation.dat pipelines/gallery/hertz.awk
	mts print reactions.frames $< | awk -f pipelines/gallery/hertz.awk > $@

$(GALLERY)/indentation.png: $(GALLERY)/indentation.tsv pipelines/gallery/indentation.gp
	gnuplot -e "data='$<'; out='$@'" pipelines/gallery/indentation.gp
