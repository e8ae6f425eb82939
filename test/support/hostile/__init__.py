"""Files as nobody means them: what a reader meets beside good ones."""
