# make gallery: examples that others can judge, with pictures: make liver, capsule, phantom, indentation, needle, compression, ventricle
#
# A liver, with and without its capsule; a bar of silicone whose bending was measured; a probe pressed into tissue beside Hertz; a needle
# with friction; brain tissue compressed at three rates; a ventricle with fibres that contracts.

GALLERY := $(OUT)/gallery
LIVER := examples/liver
PHANTOM := examples/phantom
PHANTOM_SIZES := 3.5 2.5 1.8
GALLERY_PROGRAMS := $(addprefix $(BUILD)/bin/,nodes voxels fibres interp tag ipoints support shapefn mtled mts)
GALLERY_LOG = 2> $(@:.dat=.log) || { cat $(@:.dat=.log) >&2; false; }

.PHONY: gallery liver phantom indentation needle compression capsule ventricle
gallery: liver phantom indentation needle compression capsule ventricle

$(GALLERY)/%: export PATH := $(abspath $(BUILD))/bin:$(PATH)

# ---- liver -----------------------------------------------------------------------------------------------------------

liver: $(GALLERY)/liver.dat $(GALLERY)/liver.png
	@printf 'forces, N: what is held, the kidney, what is lifted\n'; PATH=$(abspath $(BUILD))/bin:$$PATH mts print reactions $<
	$(PICTURES)

$(GALLERY)/liver.dat $(GALLERY)/capsule.dat: $(GALLERY)/%.dat: $(LIVER)/labels.nii.gz $(LIVER)/labels.tsv $(LIVER)/%.scene $(GALLERY_PROGRAMS)
	@mkdir -p $(@D)
	(voxels -h 15mm -l $(LIVER)/labels.tsv $< | tag -u mm -d 'liver|outside' -f 'tip=low:x,6%' \
	    -f 'held=ball:30,-50,140,60 and normal:0,-1,0,50 without liver|kidney' | shapefn | mtled -v $(LIVER)/$*.scene) > $@ $(GALLERY_LOG)

$(GALLERY)/liver.png: $(GALLERY)/liver.dat pipelines/render.py
	pipelines/render.py --view=-0.3,1,0.25 --cut=0,1,0,45 $< $@

capsule: $(GALLERY)/capsule.tsv $(GALLERY)/capsule.png
	@cat $<
	$(PICTURES)

# The force that lifts the tip.
$(GALLERY)/capsule.tsv: $(GALLERY)/liver.dat $(GALLERY)/capsule.dat
	(printf 'liver\tforce_N\n'; for case in liver capsule; do mts print reactions $(@D)/$$case.dat | \
	    awk -v name=$$case 'END { printf "%s\t%.3f\n", name == "liver" ? "without capsule" : "with capsule", sqrt($$1^2 + $$2^2 + $$3^2) }'; done) > $@

$(GALLERY)/capsule.png: $(GALLERY)/liver.dat $(GALLERY)/capsule.dat pipelines/render.py
	pipelines/render.py --view=-0.3,1,0.25 --cut=0,1,0,45 --most 34 --title 'without capsule' $< $(@:.png=-without.png)
	pipelines/render.py --view=-0.3,1,0.25 --cut=0,1,0,45 --most 34 --title 'with its capsule' $(word 2,$^) $(@:.png=-with.png)
	convert $(@:.png=-without.png) $(@:.png=-with.png) -append -resize 60% +dither -colors 256 $@

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

$(GALLERY)/phantom.png: $(GALLERY)/phantom-2.5.dat pipelines/render.py
	pipelines/render.py --view=-1,0,0 --up=0,1,0 --mark=0,-116.25,128 --title 'before (blue) and after; cross: the tip as measured' $< $@

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

# ---- needle ----------------------------------------------------------------------------------------------------------

NEEDLE := examples/needle

needle: $(GALLERY)/needle.tsv $(GALLERY)/needle.png
	@cat $<
	$(PICTURES)

$(GALLERY)/needle.dat $(GALLERY)/needle-smooth.dat: $(addprefix $(NEEDLE)/,needle.geo needle.scene needle.tsv middle.tsv stroke.tsv) $(GALLERY_PROGRAMS)
	@mkdir -p $(@D)
	gmsh -2 -v 2 $< -o $(@:.dat=.msh)
	cp $(NEEDLE)/*.tsv $(@D)
	sed '$(if $(findstring smooth,$@),/^friction/d; /^time_steps/d)' $(NEEDLE)/needle.scene > $(@:.dat=.scene)
	(nodes -u mm $(@:.dat=.msh) | shapefn | mtled -v $(@:.dat=.scene)) > $@ $(GALLERY_LOG)

# The depth of the tip and the force on both halves, with friction and without.
$(GALLERY)/needle.tsv: $(GALLERY)/needle.dat $(GALLERY)/needle-smooth.dat
	(printf 'depth_mm\tforce_N_per_m\twithout_friction\n'; paste <(grep -v '#' $(NEEDLE)/stroke.tsv) <(mts print reactions.frames $<) \
	    <(mts print reactions.frames $(word 2,$^)) | awk '{ printf "%.6g\t%.5g\t%.5g\n", 50 * $$2 - 1, 2 * $$8, 2 * $$15 }') > $@

$(GALLERY)/needle.png: $(GALLERY)/needle.tsv $(GALLERY)/needle.dat pipelines/gallery/needle.awk pipelines/gallery/needle.gp
	awk -f pipelines/stream.awk -f pipelines/gallery/needle.awk -v field=$(word 2,$^) -v frame=24 > $(@:.png=.rows)
	gnuplot -e "data='$<'; tissue='$(@:.png=.rows)'; out='$@'" pipelines/gallery/needle.gp

# ---- compression -----------------------------------------------------------------------------------------------------

COMPRESSION_RATES := 0.64 0.0064 0.0000064

compression: $(GALLERY)/compression.tsv $(GALLERY)/compression.png
	@cat $<
	$(PICTURES)

$(GALLERY)/compression.mts: examples/tissue/sample.geo $(GALLERY_PROGRAMS)
	@mkdir -p $(@D)
	gmsh -3 -nt 1 -v 2 $< -o $(@:.mts=.msh)
	nodes -u mm $(@:.mts=.msh) | shapefn > $@ 2> $(@:.mts=.log)

$(COMPRESSION_RATES:%=$(GALLERY)/compression-%.dat): $(GALLERY)/compression-%.dat: $(GALLERY)/compression.mts examples/tissue/compression.scene
	sed "s/^duration = .*/duration = $$(awk 'BEGIN { print 0.3 / $* }')/" $(word 2,$^) > $(@:.dat=.scene)
	mtled -v $(@:.dat=.scene) $< > $@ $(GALLERY_LOG)

# The force by the area at rest, which is the volume by the height of 10 mm.
$(COMPRESSION_RATES:%=$(GALLERY)/compression-%.rows): %.rows: %.dat $(GALLERY)/compression.mts
	mts print reactions.frames $< | awk -v area=$$(mts print points.weight $(word 2,$^) | awk '{ sum += $$1 } END { print sum / 0.01 }') \
	    '{ printf "%.6g\t%.6g\n", 1 - 0.3 * (NR - 1) / 12, $$13 / area }' > $@

$(COMPRESSION_RATES:%=$(GALLERY)/compression-%.closed): $(GALLERY)/compression-%.closed: pipelines/gallery/compression.awk
	@mkdir -p $(@D)
	awk -v rate=$* -f $< > $@

$(GALLERY)/compression.tsv: $(COMPRESSION_RATES:%=$(GALLERY)/compression-%.rows) $(COMPRESSION_RATES:%=$(GALLERY)/compression-%.closed) pipelines/gallery.mk
	(printf 'rate_per_s\tstretch\tours_Pa\tclosed_form_Pa\tratio\n'; for rate in $(COMPRESSION_RATES); do \
	    paste <(tail -n 1 $(@:.tsv=)-$$rate.rows) <(tail -n 1 $(@:.tsv=)-$$rate.closed) | \
	        awk -v rate=$$rate '{ printf "%g\t%g\t%.2f\t%.2f\t%.5f\n", rate, $$1, $$2, $$4, $$2 / $$4 }'; done) > $@

$(GALLERY)/compression.png: pipelines/gallery/compression.gp $(COMPRESSION_RATES:%=$(GALLERY)/compression-%.rows) $(COMPRESSION_RATES:%=$(GALLERY)/compression-%.closed)
	gnuplot -e "data='$(@:.png=)'; rates='$(COMPRESSION_RATES)'; out='$@'" $<

# ---- ventricle -------------------------------------------------------------------------------------------------------

VENTRICLE := examples/ventricle
VENTRICLE_FRAMES := 0 1 2 3 4 5 6 7 8 9 10

ventricle: $(GALLERY)/ventricle.tsv $(GALLERY)/ventricle.png
	@cat $<
	$(PICTURES)

$(GALLERY)/ventricle.dat: examples/hard/ventricle.geo $(addprefix $(VENTRICLE)/,ventricle.scene active.tsv pressure.tsv) $(GALLERY_PROGRAMS)
	@mkdir -p $(@D)
	gmsh -3 -nt 1 -v 2 $< -setnumber h 1.5 -o $(@:.dat=.msh)
	(nodes -u mm $(@:.dat=.msh) | fibres --from inside,90 --to 'all without inside without base,-90' --axis 0,0,1 | shapefn | \
	    mtled -v $(VENTRICLE)/ventricle.scene) > $@ $(GALLERY_LOG)

$(VENTRICLE_FRAMES:%=$(GALLERY)/ventricle.rows.%): $(GALLERY)/ventricle.rows.%: $(GALLERY)/ventricle.dat pipelines/gallery/ventricle.awk
	awk -f pipelines/gallery/ventricle.awk > $@.points
	interp -f u.frame.$* -u mm -p $@.points -o $@.dat $<
	paste <(mts print nodes.x $@.dat) <(mts print u.frame.$* $@.dat) > $@
	awk -v rows=deformed -f pipelines/gallery/ventricle.awk $@ > $(GALLERY)/ventricle.wall.$*

# The curves have a row for each frame.
$(GALLERY)/ventricle.tsv: $(VENTRICLE_FRAMES:%=$(GALLERY)/ventricle.rows.%) pipelines/gallery.mk
	(printf 'time\tpressure_kPa\tactive_kPa\tvolume_ml\tapex_inside_mm\tapex_outside_mm\n'; paste <(grep -v '#' $(VENTRICLE)/pressure.tsv) \
	    <(grep -v '#' $(VENTRICLE)/active.tsv) <(for frame in $(VENTRICLE_FRAMES); do \
	        awk -v rows=chamber -f pipelines/gallery/ventricle.awk $(@D)/ventricle.rows.$$frame; done) | \
	    awk '{ printf "%g\t%.3g\t%.3g\t%s\t%s\t%s\n", $$1, 15 * $$2, 60 * $$4, $$5, $$6, $$7 }') > $@

$(GALLERY)/ventricle.png: $(GALLERY)/ventricle.tsv pipelines/gallery/ventricle.gp
	gnuplot -e "data='$(@:.png=)'; out='$@'" pipelines/gallery/ventricle.gp
