"""Laws without a name between motor and link: what is off, what drives it; models of moving joints can carry them."""
