# Not a study: README.md afresh, with what the commands in it print now and, where they were made, the tables and
# pictures of the studies (`make brain2d table1 readme` for all of it). Pictures are made small by ImageMagick, and left
# as they are where there is none.

README_PICTURES := brain2d/section brain2d/difference table1/surface speed-error/speed-error brain3d/brain3d

.PHONY: readme
readme: export PATH := $(abspath $(BUILD))/bin:$(PATH)
readme: all
	KEEP=1 STUDIES=$(OUT) bash pipelines/readme.sh < README.md > $(BUILD)/README.md
	for picture in $(README_PICTURES); do \
	    made=$(OUT)/$$picture.png; \
	    [ ! -f $$made ] || ! command -v convert > /dev/null || convert $$made -resize 70% -colors 64 -strip PNG8:examples/brain2d/pictures/$$(basename $$picture).png; \
	done
	cp $(BUILD)/README.md README.md
