"""Problems for any program: a scene, its exact motion and the bands in which an answer to it passes."""
