CREATE FUNCTION public.recipe_version_final() RETURNS trigger
    LANGUAGE plpgsql
    AS $$ BEGIN RAISE EXCEPTION 'a stored recipe version is final, save a new one'; END $$;

CREATE TABLE public.alembic_version (
    version_num character varying(32) NOT NULL
);

CREATE TABLE public.door (
    door_id character varying(64) NOT NULL,
    bar_code character varying(64) NOT NULL,
    latest_version integer NOT NULL
);

CREATE TABLE public.recipe_version (
    door_id character varying(64) NOT NULL,
    version integer NOT NULL,
    bar_code character varying(64) NOT NULL,
    author character varying(100) NOT NULL,
    created character varying(32) NOT NULL,
    document text NOT NULL,
    sha256 character varying(64) NOT NULL
);

ALTER TABLE ONLY public.alembic_version
    ADD CONSTRAINT alembic_version_pkc PRIMARY KEY (version_num);

ALTER TABLE ONLY public.door
    ADD CONSTRAINT door_bar_code_key UNIQUE (bar_code);

ALTER TABLE ONLY public.door
    ADD CONSTRAINT door_pkey PRIMARY KEY (door_id);

ALTER TABLE ONLY public.recipe_version
    ADD CONSTRAINT recipe_version_pkey PRIMARY KEY (door_id, version);

CREATE TRIGGER recipe_version_final BEFORE DELETE OR UPDATE OR TRUNCATE ON public.recipe_version FOR EACH STATEMENT EXECUTE FUNCTION public.recipe_version_final();

ALTER TABLE ONLY public.recipe_version
    ADD CONSTRAINT recipe_version_door_id_fkey FOREIGN KEY (door_id) REFERENCES public.door(door_id);

