"""The paper's figures and the register of its statements."""
