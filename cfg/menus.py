"""Menus of live parameters: which values one can have, and what each means.

A description that ends in the values, "what is looked for: lines, segments or circles", gets a menu
of them, which rqt_reconfigure and the dashboard show. So it is the same list that the core checks,
and tools/parameters compares.
"""

import re

from dynamic_reconfigure import parameter_generator_catkin as generator
from dynamic_reconfigure.parameter_generator_catkin import bool_t, double_t, int_t, str_t

__all__ = ["ParameterGenerator", "bool_t", "double_t", "int_t", "str_t"]

VALUES = re.compile(r"(?:^|: )((?:\w+, )*\w+ or \w+)(?: \([^()]*\))?$")
# What values mean: in all menus, or in that of the parameter before the dot. dynamic_reconfigure
# refuses apostrophes in them.
MEANINGS = {
    "0": "no filter",
    "16UC1": "mm in integers of 16 bits",
    "3": "3x3 px",
    "32FC1": "m in numbers of 32 bits",
    "5": "5x5 px",
    "7": "7x7 px",
    "I1": "sum of the differences of the inverse moments",
    "I2": "sum of the differences of the moments",
    "I3": "largest relative difference of the moments",
    "acircles": "a grid of circles, every second row shifted",
    "adaptive_gaussian": "by the weighted mean around each pixel",
    "adaptive_mean": "by the mean around each pixel",
    "akaze": "AKAZE: sharp borders stay; binary descriptors",
    "and": "those that both images have",
    "any": "dark and light ones",
    "approximation": "polygons with few corners",
    "area": "mean of the area: best to make images smaller",
    "arrows": "arrows on the image",
    "auto": "what the edges of the image are not",
    "axes": "the axes x, y and z",
    "band_pass": "between two frequencies",
    "beside": "at the right of the image",
    "bgr": "blue, green, red",
    "bhattacharyya": "Bhattacharyya distance: 0 is the same",
    "binary": "white above the threshold, black below",
    "binary_inv": "black above the threshold, white below",
    "blobs": "round spots",
    "blue": "the blue one",
    "bm": "block matching: fast, few details",
    "both": "left and right, top and bottom change places",
    "bright": "what is brighter than the rest",
    "brute_force": "each is compared with all",
    "butterworth": "smoothly, the steeper the higher the order",
    "camera": "camera_info and how the camera is mounted",
    "camshift": "its size and its angle change, too",
    "canny": "edges",
    "ccoeff": "correlation without the means",
    "ccoeff_normed": "the same from -1 to 1, whatever the light",
    "ccomp": "outer borders, and those of their holes",
    "ccorr": "product of the pixels",
    "ccorr_normed": "the same from 0 to 1",
    "charuco": "a chessboard with markers, of which a part is enough",
    "chessboard": "a chessboard, all of it in view",
    "chi_square": "chi-square distance: 0 is the same",
    "circles": "a grid of circles",
    "color": "white or yellow",
    "contour": "the contours as they are",
    "correlation": "1 is the same, 0 nothing alike",
    "course": "a turn in proportion to the offset in px",
    "cross": "a cross",
    "cube": "a cube that stands on it",
    "cubic": "of 4x4 pixels",
    "daimler": "a window of 48x96 px: people far away",
    "dark": "what is darker than the rest",
    "default": "a window of 64x128 px",
    "defects": "where the hull is far from the contour",
    "dis": "dense inverse search: fast",
    "distance_transform": "things that touch, by how far pixels are from the border",
    "distinct": "colours that differ from each other",
    "ellipse": "an ellipse",
    "external": "the outermost ones only",
    "farneback": "polynomials of the neighbourhoods: slower, smooth",
    "fast": "FAST: pixels on a circle that differ from its middle",
    "first_frame": "the first one, or that of ~reset_background",
    "fixed": "the threshold that is given",
    "flann": "an index of the descriptors, fast for many",
    "flood_fill": "from each seed over what is alike",
    "fundamental": "lines in the images as they come",
    "gaussian": "a bell around each pixel",
    "grab_cut": "what a rectangle holds, from what is around it",
    "gradient": "between two edges",
    "gradient_alt": "more exact, for OpenCV 4.3 on",
    "gray": "one channel",
    "green": "the green one",
    "hann": "towards 0 at the borders",
    "harris": "the measure of corners by Harris",
    "hh": "sgbm along eight directions: slow, much memory",
    "high_pass": "high ones: edges and noise",
    "hls": "hue, lightness, saturation",
    "horizontal": "top and bottom change places",
    "hsv": "hue, saturation, value",
    "hue": "hues only",
    "hue_saturation": "hues and saturations",
    "hull": "convex hulls",
    "ideal": "at once, which makes rings",
    "intersection": "what both histograms have",
    "jpeg": "small",
    "k_means": "by colours that are alike",
    "lab": "lightness, green to red, blue to yellow",
    "lanczos4": "of 8x8 pixels",
    "last_frame": "the frame before",
    "light": "light ones",
    "line": "the line through each",
    "linear": "in proportion",
    "lines": "straight lines without ends",
    "list": "all, without a hierarchy",
    "lmeds": "least median: more than half must be right",
    "log": "logarithms of the counts",
    "low_pass": "low ones: a blurred image",
    "luv": "lightness, and two of the colour",
    "mean": "all pixels alike",
    "mean_shift": "by colours and places that hang together",
    "meanshift": "its size stays",
    "median": "the middle value around each pixel",
    "mog2": "mixtures of Gaussians, learnt for each pixel",
    "mser": "regions that stay the same at many thresholds",
    "multiple": "all that are above the threshold",
    "nearest": "that of the nearest pixel",
    "none": "no filter",
    "normalized_response": "the contrast around each pixel",
    "or": "those that one of the images has",
    "orb": "ORB: FAST in several sizes; binary descriptors",
    "otsu": "that between the two groups of gray levels",
    "over": "on the lower half of the image",
    "pid": "proportional, integral and derivative parts",
    "png": "nothing is lost",
    "previous_frame": "the one before: only what moves now",
    "ransac": "by samples: many may be wrong",
    "rect": "a rectangle",
    "rectangle": "rectangles around them, turned",
    "rectified": "rows of the rectified images",
    "red": "the red one",
    "reference": "the image of ~reference",
    "rgb": "red, green, blue",
    "rho": "by samples, the best first: fast",
    "ridge": "brighter than the floor on both sides",
    "running_average": "the mean of the last ones",
    "rvl": "less work, for depths",
    "segments": "straight lines with ends",
    "sgbm": "semi-global along five directions",
    "sgbm_3way": "semi-global along three directions: faster",
    "shi_tomasi": "the measure of corners by Shi and Tomasi",
    "sift": "SIFT: the most exact one; slow",
    "simple": "the ends of straight pieces",
    "single": "the best place",
    "sphere": "the middle of a ball",
    "sqdiff": "squared differences: 0 is the same",
    "sqdiff_normed": "the same from 0 to 1",
    "surface": "the surface that is seen",
    "tc89_kcos": "points by Teh and Chin, by k-cosine",
    "tc89_l1": "points by Teh and Chin, by 1-curvature",
    "tozero": "black below the threshold",
    "tozero_inv": "black above the threshold",
    "tree": "all, each with what is in it",
    "triangle": "that farthest from the line through the histogram",
    "trunc": "the threshold where they are above it",
    "type_5_8": "5 of 8",
    "type_7_12": "7 of 12",
    "type_9_16": "9 of 16",
    "ultrafast": "least time",
    "vertical": "left and right change places",
    "watershed": "from seeds up to edges",
    "wheel": "directions as hues",
    "x": "to the right",
    "xor": "those that one image has and the other has not",
    "xsobel": "the gradient along rows",
    "xyz": "CIE XYZ",
    "y": "downwards",
    "ycrcb": "luma, red and blue difference",
    "approximation.none": "all of them",
    "blob_color.dark": "dark ones",
    "circle_method.gradient": "an accumulator of the middles",
    "draw.ellipse": "ellipses that fit them",
    "filter.none": "all of them",
    "ground.points": "four points of the image, on the floor",
    "match.none": "nothing",
    "matcher.flow": "points of the last frame by their optical flow",
    "method.circles": "circles",
    "method.fixed": "the threshold that is given",
    "orb_score.fast": "that of FAST: faster",
    "paint.mean": "the mean colour of each segment",
    "poly_n.5": "5x5 px: sharper borders",
    "poly_n.7": "7x7 px: smoother",
    "preset.fast": "less time",
    "preset.medium": "the best of them",
    "resize_interpolation.linear": "of 2x2 pixels",
    "shape.gaussian": "as a bell, without rings",
    "show.bgr": "the image",
    "window.none": "nothing",
}


class ParameterGenerator(generator.ParameterGenerator):
    """dynamic_reconfigure's, which makes menus of the values that descriptions end in."""

    def add(
        self, name, paramtype, level, description, default=None, low=None, high=None, edit_method=""
    ):
        values = VALUES.search(description)
        if paramtype in (int_t, str_t) and values and not edit_method:
            edit_method = self._menu(name, paramtype, re.split(", | or ", values[1]))
        super().add(
            name, paramtype, level, description, default, low, high, edit_method=edit_method
        )

    def _menu(self, name, paramtype, values):
        """The edit_method of a menu; its constants bear the parameter's name, as others have the
        same values."""
        constants = []
        for value in values:
            meaning = MEANINGS.get(f"{name}.{value}") or MEANINGS.get(value)
            if meaning is None:
                raise SystemExit(f"{__file__}: no meaning for the value {value} of {name}")
            typed = int(value) if paramtype == int_t else value
            constants.append(self.const(f"{name}_{value}", paramtype, typed, meaning))
        return self.enum(constants, name)
